#include "host_sim/truth/forces/radiation_pressure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace vbar::truth {

namespace {

using fsw::Vector3;

/// To coordinates in which the Earth's ellipsoid is a sphere of the equatorial radius.
Vector3 stretched(const Vector3& v, const EarthFigure& earth) {
  return {v.x(), v.y(), v.z() / (1.0 - earth.flattening)};
}

/// The disks as circles of the plane that touches the sky at the Sun's centre.
struct PlaneCircles {
  double sun_radius;
  double earth_radius;
  double separation;  ///< distance of the centres
  double gap;         ///< separation - earth_radius, without cancellation: the Earth's limb nearest to the Sun's centre
};

PlaneCircles stereographic(const SkyDisks& disks) {
  // The ends of the Earth disk's diameter through the Sun's centre, at half their angles.
  const double near = std::tan(0.5 * (disks.separation - disks.earth_radius));
  const double far = std::tan(0.5 * (disks.separation + disks.earth_radius));
  return {2.0 * std::tan(0.5 * disks.sun_radius), far - near, far + near, 2.0 * near};
}

/// Area of the segment that a chord cuts from a circle; half the angle that the chord subtends at the centre.
double segment_area(double radius, double half_angle) {
  return radius * radius * (half_angle - std::sin(half_angle) * std::cos(half_angle));
}

}  // namespace

double cylindrical_shadow_edge(const Vector3& position, const Vector3& sun, const EarthFigure& earth) {
  // The shadow's rim is as far behind the Earth's centre as the tangent from the spacecraft to the sphere is long.
  const Vector3 r = stretched(position, earth);
  const double tangent_squared = r.squaredNorm() - earth.equatorial_radius * earth.equatorial_radius;
  return std::sqrt(std::max(tangent_squared, 0.0)) + r.dot(stretched(sun, earth).normalized());
}

SkyDisks sky_disks(const Vector3& position, const Vector3& sun, const EarthFigure& earth) {
  const Vector3 to_earth = -stretched(position, earth);
  const Vector3 to_sun = stretched(sun, earth) + to_earth;
  return {std::asin(kSunRadius / to_sun.norm()), std::asin(std::min(earth.equatorial_radius / to_earth.norm(), 1.0)),
          std::atan2(to_sun.cross(to_earth).norm(), to_sun.dot(to_earth))};
}

double penumbra_inner_edge(const SkyDisks& disks) {
  return disks.separation - std::abs(disks.earth_radius - disks.sun_radius);
}

double penumbra_sunlit_fraction(const SkyDisks& disks) {
  const auto [sun, earth, separation, gap] = stereographic(disks);
  if (gap >= sun) return 1.0;
  if (separation <= std::abs(earth - sun)) return inner_sunlit_fraction(disks);
  // The circles' common chord lies `from_sun` from the Sun's centre, towards the Earth's.
  const double from_sun = (gap * (separation + earth) + sun * sun) / (2.0 * separation);
  const double half_chord = std::sqrt(std::max((sun - from_sun) * (sun + from_sun), 0.0));
  const double overlap = segment_area(sun, std::atan2(half_chord, from_sun)) +
                         segment_area(earth, std::atan2(half_chord, separation - from_sun));
  return std::clamp(1.0 - overlap / (M_PI * sun * sun), 0.0, 1.0);
}

double inner_sunlit_fraction(const SkyDisks& disks) {
  // These are the circles of the penumbra, so that nothing jumps at the rim between them.
  const PlaneCircles circles = stereographic(disks);
  const double ratio = circles.earth_radius / circles.sun_radius;
  return std::max(0.0, 1.0 - ratio * ratio);
}

namespace {

bool not_negative(double value) {
  return std::isfinite(value) && value >= 0.0;
}

}  // namespace

RadiationPressureForce::RadiationPressureForce(const SurfaceProperties& surface, Shadow shadow,
                                               const EarthFigure& earth)
    : scale_(kSolarPressure * kAstronomicalUnit * kAstronomicalUnit * surface.radiation_coefficient *
             surface.radiation_area_m2 / surface.mass_kg),
      shadow_(shadow),
      earth_(earth) {
  if (!(std::isfinite(surface.mass_kg) && surface.mass_kg > 0.0) || !not_negative(surface.radiation_area_m2) ||
      !not_negative(surface.radiation_coefficient)) {
    throw std::invalid_argument(
        fmt::format("radiation pressure on mass {} kg, area {} m2, coefficient {}; accepted is a mass above 0, the "
                    "others not below",
                    surface.mass_kg, surface.radiation_area_m2, surface.radiation_coefficient));
  }
}

fsw::Vector3 RadiationPressureForce::acceleration_eci(const ForceInput& input) {
  const double fraction = sunlit_fraction(input);
  if (fraction == 0.0) return fsw::Vector3::Zero();
  const fsw::Vector3 from_sun = input.position_eci - input.sun_eci;
  const double distance = from_sun.norm();
  return fraction * scale_ / (distance * distance * distance) * from_sun;
}

int RadiationPressureForce::edge_count() const {
  switch (shadow_) {
    case Shadow::kNone:
      return 0;
    case Shadow::kCylindrical:
      return 1;
    case Shadow::kConical:
      return 2;
  }
  throw std::logic_error("an unknown kind of shadow");
}

double RadiationPressureForce::edge(int index, const ForceInput& input) const {
  if (shadow_ == Shadow::kCylindrical) return cylindrical_shadow_edge(input.position_eci, input.sun_eci, earth_);
  const SkyDisks disks = sky_disks(input.position_eci, input.sun_eci, earth_);
  return index == 0 ? penumbra_outer_edge(disks) : penumbra_inner_edge(disks);
}

double RadiationPressureForce::longest_step(const ForceInput& input) const {
  const bool in_penumbra = shadow_ == Shadow::kConical && !positive_[0] && positive_[1];
  if (!in_penumbra) return std::numeric_limits<double>::infinity();
  const double distance = input.position_eci.norm(), speed = input.velocity_eci.norm();
  return 0.25 * kSunRadius / (input.sun_eci - input.position_eci).norm() * distance / speed;
}

double RadiationPressureForce::sunlit_fraction(const ForceInput& input) const {
  if (shadow_ == Shadow::kNone || positive_[0]) return 1.0;
  if (shadow_ == Shadow::kCylindrical) return 0.0;
  const SkyDisks disks = sky_disks(input.position_eci, input.sun_eci, earth_);
  return positive_[1] ? penumbra_sunlit_fraction(disks) : inner_sunlit_fraction(disks);
}

}  // namespace vbar::truth
