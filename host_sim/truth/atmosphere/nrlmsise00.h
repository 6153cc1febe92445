#pragma once
// The air below 72.5 km in NRLMSISE-00: well mixed below 62.5 km, in hydrostatic equilibrium on a temperature profile
// of two splines (Hedin 1991), and tied to the thermosphere above at 72.5 km.

#include <array>
#include <memory>

#include "host_sim/truth/atmosphere/day_expansions.h"
#include "host_sim/truth/atmosphere/nrlmsise00_tables.h"
#include "host_sim/truth/atmosphere/temperature_profile.h"
#include "host_sim/truth/atmosphere/thermosphere.h"
#include "host_sim/truth/earth/space_weather.h"

namespace vbar::truth {

struct LowerAtmosphereState {
  SpeciesDensities per_cm3;  ///< no atomic species: 0
  double temperature = 0.0;  ///< K
};

/// Air below 72.5 km. Immutable; may be shared between threads.
class LowerAtmosphere {
 public:
  explicit LowerAtmosphere(const Nrlmsise00Tables& tables);

  /// Returns the state at 0 to 72.5 km. `bottom`: the thermosphere at its bottom, 72.5 km, of the same instant and
  /// place.
  LowerAtmosphereState at(double altitude_km, const LatitudeGravity& gravity, const ThermosphereState& bottom,
                          const LowerAtmosphereVariations& variations) const;

 private:
  double mixed_mass_;
  std::array<double, 3> stratosphere_{};      // mean temperatures, K, at 55, 45, 32.5 km
  std::array<double, 4> troposphere_{};       // at 20, 15, 10, 0 km
  double joint_gradient_, surface_gradient_;  // mean, K/km
  double he_ratio_, o2_ratio_, ar_ratio_;     // to N2, by number
};

// NRLMSISE-00, the empirical model of the neutral atmosphere from the ground to the exosphere (Picone, Hedin, Drob,
// Aikin 2002, J. Geophys. Res. 107(A12), 1468), with the coefficients of its release. The model was fitted up to about
// 1000 km; above, its formulas are extrapolated (diffusive equilibrium at the temperature of the exosphere).
//
// Its altitude ranges do not join smoothly, as released: variations of temperature are switched at 72.5, 123.4 and 300
// km and each species' mixing at a ceiling of its own, 160 to 450 km. The steps in density are below 1e-2 at 72.5 and
// 123.4 km, 3e-3 at 160 km, 5e-4 at 300 km and 1e-4 elsewhere (checked by its test): part of the model, whose error is
// 15 %.

/// Instant and place, in the model's own units.
struct AtmosphereInput {
  int day_of_year = 1;  ///< 1 to 366, UTC
  double ut_s = 0.0;    ///< seconds of the day, UTC
  double altitude_km = 0.0;
  double latitude_deg = 0.0;  ///< geodetic, -90 to 90
  double longitude_deg = 0.0;
  double local_solar_time_h = 0.0;  ///< the model's is ut_s/3600 + longitude_deg/15
  SolarIndices indices;
};

struct AtmosphereState {
  SpeciesDensities per_m3;
  double density = 0.0;                 ///< kg/m^3, without anomalous oxygen
  double drag_density = 0.0;            ///< kg/m^3, including it: effective for drag
  double temperature = 0.0;             ///< K
  double exospheric_temperature = 0.0;  ///< K; the mean one at 123.4 km and below
};

/// The model. Not thread-safe (results that depend on day and indices are cached): one object per thread. The result
/// depends on the input only.
class Nrlmsise00 {
 public:
  /// Makes the model; `tables`, shared between objects, must not be null.
  explicit Nrlmsise00(std::shared_ptr<const Nrlmsise00Tables> tables);

  /// Throws std::invalid_argument for an input that is not finite, or a day or latitude out of range; std::domain_error
  /// below 0 km, and where solar indices far from any observed value yield no valid density.
  AtmosphereState at(const AtmosphereInput& input);

 private:
  std::shared_ptr<const Nrlmsise00Tables> tables_;
  Thermosphere thermosphere_;
  LowerAtmosphere lower_atmosphere_;
  DayExpansions expansions_;
};

}  // namespace vbar::truth
