#include "fsw/vision/target_tracking/bearing.h"

#include <Eigen/Geometry>

#include "fsw/math/math.h"

namespace vbar::fsw::target_tracking {

Matrix3 bearing_axes(const Vector3& direction_eci, const orbit::CartesianState& servicer) {
  constexpr double kAlongNormal = 1e-6;  // squared; a target along the orbit normal has no defined vertical
  const Vector3 normal = servicer.position_eci.cross(servicer.velocity_eci);
  Vector3 in_plane = normal.cross(direction_eci);
  if (in_plane.squaredNorm() < kAlongNormal * normal.squaredNorm()) {
    in_plane = servicer.velocity_eci - servicer.velocity_eci.dot(direction_eci) * direction_eci;
  }
  in_plane /= math::sqrt(in_plane.squaredNorm());
  Matrix3 axes;
  axes.row(0) = in_plane.transpose();
  axes.row(1) = direction_eci.cross(in_plane).transpose();
  axes.row(2) = direction_eci.transpose();
  return axes;
}

Vector3 centre_of_brightness(const Vector3& target_eci, const Vector3& camera_eci, const Vector3& sun_eci,
                             double offset_m) {
  const Vector3 sight = target_eci - camera_eci;
  const double along = sight.dot(sun_eci) / sight.squaredNorm();
  return target_eci + offset_m * (sun_eci - along * sight);
}

}  // namespace vbar::fsw::target_tracking
