#include "hil_drivers/tron/calibrate/data/measurement.h"

namespace vbar::tron::calibrate {
namespace {

using Eigen::Vector3d;

Eigen::Index axis_of(char name) {
  return name - 'x';
}

}  // namespace

Eigen::Isometry3d reordered(const Eigen::Isometry3d& pose, const std::string& from, const std::string& to) {
  if (from == to) return pose;
  const Vector3d in_order = pose.linear().eulerAngles(axis_of(from[0]), axis_of(from[1]), axis_of(from[2]));
  Vector3d angles;  // about x, y, z
  for (std::size_t k = 0; k < 3; ++k) angles[axis_of(from[k])] = in_order[static_cast<Eigen::Index>(k)];
  Eigen::Isometry3d result = pose;
  result.linear().setIdentity();
  for (const char name : to) {
    const Eigen::Index axis = axis_of(name);
    result.linear() = result.linear() * Eigen::AngleAxisd(angles[axis], Vector3d::Unit(axis)).toRotationMatrix();
  }
  return result;
}

}  // namespace vbar::tron::calibrate
