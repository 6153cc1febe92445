#pragma once
// The geomagnetic activity that a quantity of NRLMSISE-00 responds to: ap above its quiet value of 4, with the
// saturation of the model, from the daily mean or from an exponentially weighted mean of the last 57 hours.

#include <array>

#include "host_sim/truth/atmosphere/nrlmsise00_tables.h"
#include "host_sim/truth/atmosphere/solar_indices.h"

namespace vbar::truth {

class EffectiveAp {
 public:
  EffectiveAp() = default;

  /// Evaluates the coupling to ap; `p` are the coefficients of the quantity.
  EffectiveAp(const Nrlmsise00Tables::Upper& p, const SolarIndices& indices);

  /// Returns the effective ap at a latitude: the decay depends on the distance of the latitude from 45 deg.
  double at(double latitude_deg) const;

 private:
  bool remembers_ = false;
  double daily_ = 0.0;
  std::array<double, 6> history_{};  // saturated
  double fading_ = 0.0;              // over three hours: exp(-fading_) at 45 deg
  double latitude_slope_ = 0.0;
};

}  // namespace vbar::truth
