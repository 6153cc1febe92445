#include "fsw/vision/target_tracking/bearing.h"

#include <Eigen/Geometry>

#include "fsw/math/math.h"

namespace vbar::fsw::target_tracking {
namespace {

// Variance of the scatter over that at 90 deg, at full phase.
constexpr double kScatterOfFull = 0.35;
// From a phase angle of about 100 deg on, bodies of flat faces have an offset that is constant.
constexpr double kLargestOffset = 1.2;  // square of it, over that at 90 deg

}  // namespace

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

double cos_phase_of(const Vector3& sight, const Vector3& sun_eci) {
  return -sight.dot(sun_eci) / math::sqrt(sight.squaredNorm());
}

double centroid_scatter_growth(double cos_phase) {
  const double dark = 1.0 - cos_phase;
  return math::sqrt(kScatterOfFull + (1.0 - kScatterOfFull) * dark * dark * dark);
}

Vector3 brightness_displacement(const Vector3& sight, const Vector3& sun_eci) {
  // Across the line of sight the Sun's direction has the length sin a.
  const double along = sight.dot(sun_eci) / sight.squaredNorm();
  const Vector3 across = sun_eci - along * sight;
  const double dark = 1.0 - cos_phase_of(sight, sun_eci);
  const double length = math::sqrt(dark < kLargestOffset ? dark : kLargestOffset);
  constexpr double kMinSine = 1e-6;  // at full phase and at the Sun itself no direction is defined
  const double sine = math::sqrt(across.squaredNorm());
  return (length / (sine > kMinSine ? sine : kMinSine)) * across;
}

Vector3 earthlight_displacement(const Vector3& sight, const Vector3& target_eci) {
  const Vector3 to_earth = -target_eci / math::sqrt(target_eci.squaredNorm());
  return to_earth - sight.dot(to_earth) / sight.squaredNorm() * sight;
}

Vector3 centre_of_brightness(const Vector3& target_eci, const Vector3& camera_eci, const Vector3& sun_eci,
                             const BrightnessOffsets& offsets) {
  const Vector3 sight = target_eci - camera_eci;
  return target_eci + offsets.to_sun_m * brightness_displacement(sight, sun_eci) +
         offsets.to_earth_m * earthlight_displacement(sight, target_eci);
}

}  // namespace vbar::fsw::target_tracking
