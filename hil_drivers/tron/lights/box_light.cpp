#include "hil_drivers/tron/lights/box_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <Eigen/Geometry>

#include "hil_drivers/tron/lights/bounded_least_squares.h"
#include "hil_drivers/tron/lights/form_factor.h"
#include "hil_drivers/tron/lights/sphere_normals.h"
#include "host_sim/twins/camera/earth_light.h"

namespace vbar::tron {
namespace {

using fsw::Vector3;

constexpr double kSteepest = 0.9;
constexpr double kSmallestHalfAngle = 1e-3;  // rad; as the twin's renderer

/// Anticlockwise as seen from the room; two edges are horizontal.
std::array<Vector3, 4> corners_of(const LightBox& box, double side_m) {
  const Vector3 reference = std::abs(box.normal.z()) < kSteepest ? Vector3::UnitZ() : Vector3::UnitX();
  const Vector3 right = 0.5 * side_m * reference.cross(box.normal).normalized();
  const Vector3 up = 0.5 * side_m * box.normal.cross(right).normalized();
  return {box.centre_m - right - up, box.centre_m + right - up, box.centre_m + right + up, box.centre_m - right + up};
}

}  // namespace

BoxLight::BoxLight(const BenchFile& bench, const std::array<double, kBoxes>& full_light)
    : full_light_(full_light),
      exitance_ratio_(bench.boxes.exitance_ratio),
      radius_m_(0.5 * bench.scale * (bench.target.body_high_m - bench.target.body_low_m).mean()) {
  for (std::size_t k = 0; k < kBoxes; ++k) corners_L_[k] = corners_of(bench.boxes.boxes[k], bench.boxes.side_m);
}

Eigen::MatrixXd BoxLight::irradiances(const Vector3& centre_L) const {
  const auto& normals = sphere_normals();
  Eigen::MatrixXd irradiances(static_cast<Eigen::Index>(normals.size()), static_cast<Eigen::Index>(kBoxes));
  for (Eigen::Index j = 0; j < irradiances.rows(); ++j) {
    const Vector3& normal = normals[static_cast<std::size_t>(j)];
    const Vector3 point = centre_L + radius_m_ * normal;
    for (Eigen::Index i = 0; i < irradiances.cols(); ++i)
      irradiances(j, i) = exitance_ratio_ * form_factor(point, normal, corners_L_[static_cast<std::size_t>(i)]);
  }
  return irradiances;
}

NormalIrradiances BoxLight::irradiances(const EarthLight& earth) const {
  const auto& normals = sphere_normals();
  const double sine = std::sin(std::clamp(earth.half_angle, kSmallestHalfAngle, 0.5 * std::numbers::pi));
  NormalIrradiances irradiances(static_cast<Eigen::Index>(normals.size()));
  for (Eigen::Index j = 0; j < irradiances.size(); ++j)
    irradiances[j] = earth.ratio * twins::camera::earth_light_factor(
                                       normals[static_cast<std::size_t>(j)].dot(earth.direction_L), sine);
  return irradiances;
}

BoxPowers BoxLight::powers(const Vector3& centre_L, const EarthLight& earth) const {
  if (!centre_L.allFinite() || !earth.direction_L.allFinite() || !std::isfinite(earth.half_angle + earth.ratio))
    throw std::invalid_argument("light boxes: a number of the target's place or of the Earth is not finite");
  const NormalIrradiances wanted = irradiances(earth);
  BoxPowers powers;
  const double largest = wanted.maxCoeff();
  if (largest <= 0.0) return powers;
  Eigen::MatrixXd full = irradiances(centre_L);
  for (std::size_t k = 0; k < kBoxes; ++k) full.col(static_cast<Eigen::Index>(k)) *= full_light_[k];
  const BoundedSolution solution = bounded_least_squares(full, wanted);
  for (std::size_t k = 0; k < kBoxes; ++k) powers.power[k] = full_light_[k] * solution.x[static_cast<Eigen::Index>(k)];
  powers.misfit = solution.residual_norm / std::sqrt(static_cast<double>(wanted.size())) / largest;
  return powers;
}

}  // namespace vbar::tron
