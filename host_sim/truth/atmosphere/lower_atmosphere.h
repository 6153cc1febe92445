#pragma once
// The air below 72.5 km in NRLMSISE-00: well mixed below 62.5 km, in hydrostatic equilibrium on a temperature profile
// of two splines (Hedin 1991), and tied to the thermosphere above at 72.5 km.

#include <array>

#include "host_sim/truth/atmosphere/day_expansions.h"
#include "host_sim/truth/atmosphere/latitude_gravity.h"
#include "host_sim/truth/atmosphere/nrlmsise00_tables.h"
#include "host_sim/truth/atmosphere/species.h"
#include "host_sim/truth/atmosphere/thermosphere.h"

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

}  // namespace vbar::truth
