#pragma once
// The constituents of the air in NRLMSISE-00.

#include <cstddef>

#include "host_sim/truth/atmosphere/day_expansions.h"
#include "host_sim/truth/atmosphere/nrlmsise00_tables.h"
#include "host_sim/truth/atmosphere/temperature_profile.h"

namespace vbar::truth {

/// Number densities, in the unit that the name of the variable states.
struct SpeciesDensities {
  double he = 0.0;
  double o = 0.0;
  double n2 = 0.0;
  double o2 = 0.0;
  double ar = 0.0;
  double h = 0.0;
  double n = 0.0;
  double anomalous_o = 0.0;  ///< hot and ionised oxygen, relevant to drag at night above 500 km
};

// Composition and temperature of NRLMSISE-00 from 72.5 km up: each species in diffusive equilibrium above its
// turbopause and mixed with the others below, with the corrections of chemistry and transport (Hedin 1987; Picone et
// al. 2002).

/// Quantities that the thermosphere of an instant and place depends on besides the altitude.
struct ThermosphereConditions {
  UpperVariations upper{};
  LowerThermosphereVariations lower{};  ///< used below Thermosphere::kLowerVariationsCeilingKm only; 0 above
  double turbopause_season = 0.0;       ///< sine of latitude times the annual wave that displaces the turbopause
  double flux_excess = 0.0;             ///< 81-day mean of F10.7, less 150
};

struct ThermosphereState {
  SpeciesDensities per_cm3;
  double mixed_n2_per_cm3 = 0.0;        ///< N2 as if mixed all the way up, to which the air below 72.5 km is tied
  double exospheric_temperature = 0.0;  ///< K
  double temperature = 0.0;             ///< K
  double bottom_temperature = 0.0;      ///< K, at 72.5 km
  double bottom_gradient = 0.0;         ///< K/km, there
};

/// Air from 72.5 km up. Immutable; may be shared between threads.
class Thermosphere {
 public:
  static constexpr double kBottomKm = 72.5;
  static constexpr double kLowerVariationsCeilingKm = 300.0;

  explicit Thermosphere(const Nrlmsise00Tables& tables);

  /// Returns the state at kBottomKm or above.
  ThermosphereState at(double altitude_km, const LatitudeGravity& gravity,
                       const ThermosphereConditions& conditions) const;

 private:
  /// A correction that vanishes upwards about a height: ln n += amplitude / (1 + mean of exp((z - height) / scale)).
  struct Transition {
    double height_km = 0.0, scale_km = 1.0, second_scale_km = 1.0;

    double log_factor(double altitude_km, double amplitude) const;
  };

  struct Species {
    double mass = 0.0;
    double thermal_diffusion = 0.0;
    double mixing_ceiling_km = 0.0;  ///< above it, mixing and chemistry below have no effect
    double log_reference = 0.0;      ///< ln of the mean density at 120 km, 1/cm^3
    double homopause_km = 0.0;
    double log_mixing_ratio = 0.0;  ///< ln of its share of the mixed atmosphere, relative to N2
    Transition to_mixing_ratio;
    double chemistry_amplitude = 0.0;
    Transition chemistry;
  };

  struct Column;

  static Species species(const Nrlmsise00Tables& tables, std::size_t pdm_row, std::size_t pd_row, double mass,
                         double thermal_diffusion, double mixing_ceiling_km);
  LowerThermosphereNodes lower_nodes(const LowerThermosphereVariations& variations) const;
  BatesProfile bates_profile(double altitude_km, const UpperVariations& upper) const;

  // All of these are ln of a number density in 1/cm^3.
  static double log_diffusive(const Species& species, double variation, const ThermosphereLevel& level);
  double log_at_homopause(const Species& species, double homopause_km, double variation, const Column& column) const;
  double log_mixed(double log_at_homopause, const ThermosphereLevel& level) const;
  double log_net(const Species& species, double log_diffusive, double log_mixed) const;
  double log_density(const Species& species, double variation, const Column& column) const;
  double log_oxygen(const ThermosphereConditions& conditions, const Column& column) const;
  double log_molecular_oxygen(const ThermosphereConditions& conditions, const Column& column) const;
  double log_anomalous_oxygen(double variation, const Column& column) const;

  double mean_exospheric_, mean_boundary_, mean_gradient_, boundary_km_;
  LowerThermosphereNodes mean_nodes_;
  double mixed_mass_, mixing_depth_;
  double turbopause_factor_, turbopause_variation_;
  Species he_, o_, n2_, o2_, ar_, h_, n_, anomalous_o_;
  double oxygen_amplitude_, oxygen_flux_slope_;
  Transition molecular_oxygen_chemistry_;
  double molecular_oxygen_amplitude_;
  double anomalous_temperature_, anomalous_km_, anomalous_scale_km_;
};

}  // namespace vbar::truth
