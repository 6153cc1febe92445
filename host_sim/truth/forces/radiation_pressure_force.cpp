#include "host_sim/truth/forces/radiation_pressure_force.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

namespace vbar::truth {
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
