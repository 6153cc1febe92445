#include "host_sim/truth/atmosphere/nrlmsise00.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "host_sim/truth/atmosphere/horizontal_expansion.h"
#include "host_sim/truth/atmosphere/temperature_profile.h"

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

namespace {

constexpr double kMeanFlux = 150.0;

void require(bool condition, std::string_view quantity, double value, std::string_view accepted) {
  if (!condition) {
    throw std::invalid_argument(fmt::format("atmosphere: {} is {}; accepted is {}", quantity, value, accepted));
  }
}

void require_finite(std::string_view quantity, double value) {
  require(std::isfinite(value), quantity, value, "a number");
}

void check(const AtmosphereInput& input) {
  require(input.day_of_year >= 1 && input.day_of_year <= 366, "the day of the year", input.day_of_year, "1 to 366");
  require_finite("universal time", input.ut_s);
  require_finite("the altitude", input.altitude_km);
  require(std::abs(input.latitude_deg) <= 90.0, "the latitude in degrees", input.latitude_deg, "-90 to 90");
  require_finite("the longitude", input.longitude_deg);
  require_finite("local solar time", input.local_solar_time_h);
  require_finite("F10.7", input.indices.f107);
  require_finite("the mean of F10.7", input.indices.f107_average);
  if (input.indices.geomagnetic_index == GeomagneticIndex::kDaily) {
    require_finite("Ap", input.indices.ap_daily);
  } else {
    for (const double ap : input.indices.ap_history) require_finite("ap", ap);
  }
  if (input.altitude_km < 0.0) {
    throw std::domain_error(
        fmt::format("atmosphere: the altitude is {:.3f} km; the model begins at the ground, 0 km", input.altitude_km));
  }
}

/// With molar masses and the atomic mass unit as the model rounds them.
double mass_density(const SpeciesDensities& per_m3) {
  constexpr double kAtomicMassUnit = 1.66e-27;
  return kAtomicMassUnit * (4.0 * per_m3.he + 16.0 * per_m3.o + 28.0 * per_m3.n2 + 32.0 * per_m3.o2 + 40.0 * per_m3.ar +
                            per_m3.h + 14.0 * per_m3.n);
}

double anomalous_mass_density(const SpeciesDensities& per_m3) {
  return 16.0 * 1.66e-27 * per_m3.anomalous_o;
}

SpeciesDensities per_m3(const SpeciesDensities& per_cm3) {
  constexpr double kPerCubicMetre = 1e6;
  return {kPerCubicMetre * per_cm3.he, kPerCubicMetre * per_cm3.o,          kPerCubicMetre * per_cm3.n2,
          kPerCubicMetre * per_cm3.o2, kPerCubicMetre * per_cm3.ar,         kPerCubicMetre * per_cm3.h,
          kPerCubicMetre * per_cm3.n,  kPerCubicMetre * per_cm3.anomalous_o};
}

}  // namespace

Nrlmsise00::Nrlmsise00(std::shared_ptr<const Nrlmsise00Tables> tables)
    : tables_(tables ? std::move(tables) : throw std::invalid_argument("NRLMSISE-00 needs its coefficients")),
      thermosphere_(*tables_),
      lower_atmosphere_(*tables_),
      expansions_(tables_) {}

AtmosphereState Nrlmsise00::at(const AtmosphereInput& input) {
  check(input);
  expansions_.set_day(input.day_of_year, input.indices);
  const HorizontalSeries functions =
      horizontal_functions({input.latitude_deg, input.longitude_deg, input.local_solar_time_h, input.ut_s});
  const double sin_latitude = functions[kZonal + 1];
  const LatitudeGravity gravity(sin_latitude);

  ThermosphereConditions conditions;
  conditions.upper = expansions_.upper(functions, input.latitude_deg);
  if (input.altitude_km < Thermosphere::kLowerVariationsCeilingKm) {
    conditions.lower = expansions_.lower_thermosphere(functions, input.latitude_deg);
  }
  conditions.turbopause_season = sin_latitude * expansions_.turbopause_season();
  conditions.flux_excess = input.indices.f107_average - kMeanFlux;
  const ThermosphereState above =
      thermosphere_.at(std::max(input.altitude_km, Thermosphere::kBottomKm), gravity, conditions);

  AtmosphereState state;
  state.exospheric_temperature = above.exospheric_temperature;
  if (input.altitude_km >= Thermosphere::kBottomKm) {
    state.per_m3 = per_m3(above.per_cm3);
    state.temperature = above.temperature;
  } else {
    const LowerAtmosphereState below =
        lower_atmosphere_.at(input.altitude_km, gravity, above, expansions_.lower_atmosphere(functions));
    state.per_m3 = per_m3(below.per_cm3);
    state.temperature = below.temperature;
  }
  state.density = mass_density(state.per_m3);
  state.drag_density = state.density + anomalous_mass_density(state.per_m3);
  if (!(state.temperature > 0.0 && state.density > 0.0 && std::isfinite(state.drag_density))) {
    throw std::domain_error(
        fmt::format("atmosphere: no density at {:.1f} km with F10.7 {}, mean {}; the indices are outside the model",
                    input.altitude_km, input.indices.f107, input.indices.f107_average));
  }
  return state;
}

}  // namespace vbar::truth
