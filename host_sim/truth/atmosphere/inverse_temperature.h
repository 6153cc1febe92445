#pragma once
// Temperature below 123 km in NRLMSISE-00: the reciprocal of temperature is a cubic spline in geopotential altitude
// through a few nodes, with given gradients at both ends; so the weight of the air above is an exact integral.

#include <array>
#include <cmath>

#include "host_sim/truth/atmosphere/clamped_spline.h"
#include "host_sim/truth/atmosphere/latitude_gravity.h"

namespace vbar::truth {

struct SplineLevel {
  double temperature = 0.0;  ///< K
  double weight = 0.0;       ///< minus the integral of g dz / (R T) from the top node, mol/g
};

/// Profile through N nodes, altitudes (km) descending; temperatures K; gradients K/km at the highest and the lowest
/// node.
template <int N>
class InverseTemperature {
 public:
  using Nodes = std::array<double, N>;

  InverseTemperature() = default;

  InverseTemperature(const LatitudeGravity& gravity, const Nodes& altitude_km, const Nodes& temperature,
                     double top_gradient, double bottom_gradient)
      : top_km_(altitude_km[0]), depth_(gravity.geopotential_km(altitude_km[N - 1], top_km_)) {
    Nodes x, y;
    for (int i = 0; i < N; ++i) {
      x[i] = gravity.geopotential_km(altitude_km[i], top_km_) / depth_;
      y[i] = 1.0 / temperature[i];
    }
    const double radii = (gravity.radius_km + altitude_km[N - 1]) / (gravity.radius_km + top_km_);
    spline_ = ClampedSpline<N>(x, y, -top_gradient * y[0] * y[0] * depth_,
                               -bottom_gradient * y[N - 1] * y[N - 1] * depth_ * radii * radii);
    weight_ = gravity.at(top_km_) * depth_ / kModelGasConstant;
  }

  SplineLevel at(const LatitudeGravity& gravity, double altitude_km) const {
    const double x = gravity.geopotential_km(altitude_km, top_km_) / depth_;
    return {1.0 / spline_.value(x), -weight_ * spline_.integral(x)};
  }

 private:
  double top_km_ = 0.0;
  double depth_ = 0.0;   // geopotential km, negative
  double weight_ = 0.0;  // weight of the whole depth at 1 K
  ClampedSpline<N> spline_;
};

}  // namespace vbar::truth
