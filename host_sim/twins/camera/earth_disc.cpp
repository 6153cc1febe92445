#include "host_sim/twins/camera/earth_disc.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "host_sim/truth/forces/radiation_pressure.h"

namespace vbar::twins::camera {

namespace {

using fsw::Vector3;

constexpr double kAlbedo = 0.3;
const truth::EarthFigure kFigure;
const double kStretch = 1.0 / (1.0 - kFigure.flattening);

Vector3 stretched(const Vector3& eci) {
  return {eci.x(), eci.y(), eci.z() * kStretch};
}

/// Outward normal of the ellipsoid at a stretched point of its surface; ECI, unit.
Vector3 normal_at(const Vector3& point) {
  return stretched(point).normalized();
}

}  // namespace

EarthDisc::EarthDisc(const Vector3& position_eci, const Vector3& sun_eci)
    : position_(position_eci),
      sun_direction_(sun_eci.normalized()),
      stretched_position_(stretched(position_eci)),
      centre_direction_eci_(-position_eci.normalized()),
      angular_radius_(std::asin(std::min(1.0, kFigure.equatorial_radius / position_eci.norm()))) {}

EarthSight EarthDisc::look(const Vector3& direction_eci, double blur) const {
  const double radius = kFigure.equatorial_radius;
  const Vector3 d = stretched(direction_eci);
  const double d2 = d.squaredNorm();
  const double nearest = -stretched_position_.dot(d) / d2;  // m along the direction, which stretching leaves as it is
  EarthSight sight;
  if (nearest <= 0.0) return sight;
  const Vector3 foot = stretched_position_ + nearest * d;
  const double height = foot.norm() - radius;
  const double to_limb = std::sqrt(std::max(stretched_position_.squaredNorm() - radius * radius, 1.0));
  sight.covered = std::clamp(0.5 - height / (to_limb * blur), 0.0, 1.0);
  if (sight.covered == 0.0) return sight;
  const double half_chord = height < 0.0 ? std::sqrt((radius * radius - foot.squaredNorm()) / d2) : 0.0;
  sight.distance_m = nearest - half_chord;
  sight.cosine_of_sun = normal_at(stretched_position_ + sight.distance_m * d).dot(sun_direction_);
  return sight;
}

bool EarthDisc::hides(const Vector3& direction_eci, double distance_m) const {
  const EarthSight sight = look(direction_eci, 1e-9);
  return sight.covered > 0.5 && distance_m > sight.distance_m;
}

double EarthDisc::radiance(double sun_photons_per_m2_s) {
  return sun_photons_per_m2_s * kAlbedo / M_PI;
}

Vector3 EarthDisc::light_eci(double sun_photons_per_m2_s) const {
  // Midpoint rule over the disc: rings of equal solid angle, evenly spaced around.
  constexpr int kRings = 24, kAround = 48;
  const Vector3 side = centre_direction_eci_.unitOrthogonal();
  const Vector3 other = centre_direction_eci_.cross(side);
  const double cap = 1.0 - std::cos(angular_radius_);
  const double solid_angle = 2.0 * M_PI * cap / (kRings * kAround);
  Vector3 light = Vector3::Zero();
  for (int ring = 0; ring < kRings; ++ring) {
    const double cosine = 1.0 - cap * (ring + 0.5) / kRings;
    const double sine = std::sqrt(1.0 - cosine * cosine);
    for (int k = 0; k < kAround; ++k) {
      const double turn = 2.0 * M_PI * (k + 0.5) / kAround;
      const Vector3 direction =
          cosine * centre_direction_eci_ + sine * (std::cos(turn) * side + std::sin(turn) * other);
      const EarthSight sight = look(direction, 1e-6);
      light += sight.covered * std::max(0.0, sight.cosine_of_sun) * direction;
    }
  }
  return radiance(sun_photons_per_m2_s) * solid_angle * light;
}

double earth_light_factor(double cosine, double sine_earth) {
  if (cosine >= sine_earth) return cosine;
  if (cosine <= -sine_earth) return 0.0;
  const double sin2 = sine_earth * sine_earth, sine = std::sqrt(1.0 - cosine * cosine);
  const double x = std::sqrt(std::max(0.0, 1.0 / sin2 - 1.0)), y = std::clamp(-x * cosine / sine, -1.0, 1.0);
  const double s = sine * std::sqrt(1.0 - y * y);
  return std::max(0.0, ((cosine * std::acos(y) - x * s) * sin2 + std::atan2(s, x)) / (M_PI * sin2));
}

}  // namespace vbar::twins::camera
