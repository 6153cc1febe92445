#pragma once
// The temperature profile of NRLMSISE-00 from 72.5 km up, with the quantities of diffusive equilibrium. Above 123 km it
// is Bates's: exponential in geopotential altitude, for which equilibrium has a closed form (Walker 1965); below, a
// spline.

#include <array>

#include "host_sim/truth/atmosphere/inverse_temperature.h"
#include "host_sim/truth/atmosphere/latitude_gravity.h"

namespace vbar::truth {

/// Temperature profile T(z) = exospheric - (exospheric - boundary) exp(-shape * geopotential altitude above the
/// boundary).
struct BatesProfile {
  double exospheric = 0.0;   ///< K
  double boundary = 0.0;     ///< K, at boundary_km
  double shape = 0.0;        ///< 1/km
  double boundary_km = 0.0;  ///< 120 km
};

/// Nodes of the profile below the joint with Bates's.
struct LowerThermosphereNodes {
  std::array<double, 5> altitude_km{};  ///< the joint (123.4 km), 110, 100, 90, 72.5
  std::array<double, 4> temperature{};  ///< K, at the lower four
  double bottom_gradient = 0.0;         ///< K/km, at the lowest
};

/// Level of the profile. A species of molar mass M and thermal diffusion coefficient alpha in equilibrium has, relative
/// to the boundary,
///   ln n = (1 + alpha) log_cooling + M weight.
struct ThermosphereLevel {
  double temperature = 0.0;  ///< K
  double log_cooling = 0.0;  ///< ln(T at the boundary / T)
  double weight = 0.0;       ///< minus the integral of g dz / (R T) from the boundary, mol/g
};

/// Returns the level of Bates's profile at an altitude, the joint or above.
ThermosphereLevel bates_level(const LatitudeGravity& gravity, const BatesProfile& bates, double altitude_km);

class ThermosphereTemperature {
 public:
  ThermosphereTemperature(const LatitudeGravity& gravity, const BatesProfile& bates,
                          const LowerThermosphereNodes& nodes);

  /// Returns the level at 72.5 km or above.
  ThermosphereLevel at(double altitude_km) const;

 private:
  LatitudeGravity gravity_;
  BatesProfile bates_;
  double joint_km_;
  ThermosphereLevel joint_;
  InverseTemperature<5> below_;
};

}  // namespace vbar::truth
