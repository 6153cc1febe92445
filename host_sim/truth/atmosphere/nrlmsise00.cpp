#include "host_sim/truth/atmosphere/nrlmsise00.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "host_sim/truth/atmosphere/horizontal_basis.h"

namespace vbar::truth {
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
