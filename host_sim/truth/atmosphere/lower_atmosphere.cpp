#include "host_sim/truth/atmosphere/lower_atmosphere.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "host_sim/truth/atmosphere/inverse_temperature.h"

namespace vbar::truth {
namespace {

constexpr double kMixedKm = 62.5;  // below, all species have the mixed ratio
constexpr std::array<double, 4> kStratosphereNodesKm = {Thermosphere::kBottomKm, 55.0, 45.0, 32.5};
constexpr std::array<double, 5> kTroposphereNodesKm = {32.5, 20.0, 15.0, 10.0, 0.0};

/// Gradient of 1/T's spline is given at the mean temperature and kept in proportion.
double gradient_at(double mean_gradient, double variation, double temperature, double mean_temperature) {
  const double warming = temperature / mean_temperature;
  return mean_gradient * (1.0 + variation) * warming * warming;
}

}  // namespace

LowerAtmosphere::LowerAtmosphere(const Nrlmsise00Tables& t)
    : mixed_mass_(t.pdm[2][4]),
      joint_gradient_(t.pma[9][0] * t.pavgm[8]),
      surface_gradient_(t.pma[7][0] * t.pavgm[7]),
      he_ratio_(t.pdm[0][1]),
      o2_ratio_(t.pdm[3][1]),
      ar_ratio_(t.pdm[4][1]) {
  for (std::size_t i = 0; i < stratosphere_.size(); ++i) stratosphere_[i] = t.pma[i][0] * t.pavgm[i];
  for (std::size_t i = 0; i < troposphere_.size(); ++i) troposphere_[i] = t.pma[3 + i][0] * t.pavgm[3 + i];
}

LowerAtmosphereState LowerAtmosphere::at(double altitude_km, const LatitudeGravity& gravity,
                                         const ThermosphereState& bottom,
                                         const LowerAtmosphereVariations& variations) const {
  std::array<double, 4> upper{bottom.bottom_temperature};
  for (std::size_t i = 0; i < 3; ++i) upper[i + 1] = stratosphere_[i] / (1.0 - variations.stratosphere[i]);
  const double joint_gradient = gradient_at(joint_gradient_, variations.joint_gradient, upper[3], stratosphere_[2]);
  const InverseTemperature<4> stratosphere(gravity, kStratosphereNodesKm, upper, bottom.bottom_gradient,
                                           joint_gradient);
  const double joint_km = kStratosphereNodesKm[3];
  SplineLevel level = stratosphere.at(gravity, std::max(altitude_km, joint_km));
  if (altitude_km <= joint_km) {
    std::array<double, 5> lower{upper[3]};
    for (std::size_t i = 0; i < 4; ++i) lower[i + 1] = troposphere_[i] / (1.0 - variations.troposphere[i]);
    const double surface_gradient =
        gradient_at(surface_gradient_, variations.surface_gradient, lower[4], troposphere_[3]);
    const InverseTemperature<5> troposphere(gravity, kTroposphereNodesKm, lower, joint_gradient, surface_gradient);
    const double weight_above = level.weight;
    level = troposphere.at(gravity, altitude_km);
    level.weight += weight_above;
  }

  const double mixed_n2 =
      bottom.mixed_n2_per_cm3 * bottom.bottom_temperature / level.temperature * std::exp(mixed_mass_ * level.weight);
  // From the mixed ratio at 62.5 km to that of the thermosphere's bottom.
  const double blend = altitude_km > kMixedKm
                           ? 1.0 - (Thermosphere::kBottomKm - altitude_km) / (Thermosphere::kBottomKm - kMixedKm)
                           : 0.0;
  const auto blended = [&](double mixed, double at_bottom, double mixed_at_bottom) {
    return mixed * (1.0 + blend * (at_bottom / mixed_at_bottom - 1.0));
  };
  const SpeciesDensities& top = bottom.per_cm3;
  LowerAtmosphereState state;
  state.temperature = level.temperature;
  state.per_cm3.n2 = blended(mixed_n2, top.n2, bottom.mixed_n2_per_cm3);
  state.per_cm3.he = blended(state.per_cm3.n2 * he_ratio_, top.he, top.n2 * he_ratio_);
  state.per_cm3.o2 = blended(state.per_cm3.n2 * o2_ratio_, top.o2, top.n2 * o2_ratio_);
  state.per_cm3.ar = blended(state.per_cm3.n2 * ar_ratio_, top.ar, top.n2 * ar_ratio_);
  return state;
}

}  // namespace vbar::truth
