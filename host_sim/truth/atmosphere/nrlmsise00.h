#pragma once
// NRLMSISE-00, the empirical model of the neutral atmosphere from the ground to the exosphere (Picone, Hedin, Drob,
// Aikin 2002, J. Geophys. Res. 107(A12), 1468), with the coefficients of its release. The model was fitted up to about
// 1000 km; above, its formulas are extrapolated (diffusive equilibrium at the temperature of the exosphere).
//
// Its altitude ranges do not join smoothly, as released: variations of temperature are switched at 72.5, 123.4 and 300
// km and each species' mixing at a ceiling of its own, 160 to 450 km. The steps in density are below 1e-2 at 72.5 and
// 123.4 km, 3e-3 at 160 km, 5e-4 at 300 km and 1e-4 elsewhere (checked by its test): part of the model, whose error is
// 15 %.

#include <memory>

#include "host_sim/truth/atmosphere/day_expansions.h"
#include "host_sim/truth/atmosphere/lower_atmosphere.h"
#include "host_sim/truth/atmosphere/nrlmsise00_tables.h"
#include "host_sim/truth/atmosphere/solar_indices.h"
#include "host_sim/truth/atmosphere/species.h"
#include "host_sim/truth/atmosphere/thermosphere.h"

namespace vbar::truth {

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
