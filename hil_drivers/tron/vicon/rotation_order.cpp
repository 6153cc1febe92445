#include "hil_drivers/tron/vicon/rotation_order.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

namespace vbar::tron::vicon {
namespace {

std::array<Eigen::Index, 3> axes_of(std::string_view order) {
  if (std::ranges::find(kRotationOrders, order) == kRotationOrders.end())
    throw std::invalid_argument("'" + std::string(order) + "' is not an order of three rotations; one is xyz");
  return {order[0] - 'x', order[1] - 'x', order[2] - 'x'};
}

}  // namespace

fsw::Matrix3 rotation_of(const std::array<double, 3>& angles_rad, std::string_view order) {
  fsw::Matrix3 rotation = fsw::Matrix3::Identity();
  for (const Eigen::Index axis : axes_of(order))
    rotation =
        rotation *
        Eigen::AngleAxisd(angles_rad[static_cast<std::size_t>(axis)], fsw::Vector3::Unit(axis)).toRotationMatrix();
  return rotation;
}

std::array<double, 3> angles_of(const fsw::Matrix3& rotation, std::string_view order) {
  const auto axes = axes_of(order);
  const fsw::Vector3 in_order = rotation.eulerAngles(axes[0], axes[1], axes[2]);
  std::array<double, 3> angles{};
  for (std::size_t k = 0; k < 3; ++k)
    angles[static_cast<std::size_t>(axes[k])] = in_order[static_cast<Eigen::Index>(k)];
  return angles;
}

}  // namespace vbar::tron::vicon
