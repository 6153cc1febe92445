#include "host_sim/truth/atmosphere/temperature_profile.h"

#include <cmath>

namespace vbar::truth {

ThermosphereLevel bates_level(const LatitudeGravity& gravity, const BatesProfile& bates, double altitude_km) {
  const double height = gravity.geopotential_km(altitude_km, bates.boundary_km);
  const double temperature = bates.exospheric - (bates.exospheric - bates.boundary) * std::exp(-bates.shape * height);
  const double log_cooling = std::log(bates.boundary / temperature);
  const double weight_per_km = gravity.at(bates.boundary_km) / (kModelGasConstant * bates.exospheric);
  return {temperature, log_cooling, weight_per_km * (log_cooling / bates.shape - height)};
}

ThermosphereTemperature::ThermosphereTemperature(const LatitudeGravity& gravity, const BatesProfile& bates,
                                                 const LowerThermosphereNodes& nodes)
    : gravity_(gravity),
      bates_(bates),
      joint_km_(nodes.altitude_km[0]),
      joint_(bates_level(gravity, bates, joint_km_)) {
  const double radii = (gravity.radius_km + bates.boundary_km) / (gravity.radius_km + joint_km_);
  const double joint_gradient = (bates.exospheric - joint_.temperature) * bates.shape * radii * radii;
  const auto& t = nodes.temperature;
  below_ = InverseTemperature<5>(gravity, nodes.altitude_km, {joint_.temperature, t[0], t[1], t[2], t[3]},
                                 joint_gradient, nodes.bottom_gradient);
}

ThermosphereLevel ThermosphereTemperature::at(double altitude_km) const {
  if (altitude_km >= joint_km_) return bates_level(gravity_, bates_, altitude_km);
  const SplineLevel level = below_.at(gravity_, altitude_km);
  return {level.temperature, std::log(bates_.boundary / level.temperature), joint_.weight + level.weight};
}

}  // namespace vbar::truth
