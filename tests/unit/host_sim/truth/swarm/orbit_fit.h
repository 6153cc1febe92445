#pragma once
// Least squares of a propagated orbit against a measured one: the six components of the start and the scale of drag.

#include <functional>
#include <vector>

#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"

namespace vbar::truth::test {

/// What is adjusted.
struct OrbitStart {
  fsw::orbit::CartesianState state;
  double drag_scale = 1.0;
};

/// Positions (m, ECI) at the instants of the measured orbit.
using Positions = std::vector<fsw::Vector3>;
using Propagate = std::function<Positions(const OrbitStart&)>;

/// The distances between two orbits at the same instants, m.
struct Distances {
  double rms = 0.0;
  double largest = 0.0;
};
Distances distances(const Positions& a, const Positions& b);

/// Gauss-Newton. The derivatives, by differences of propagations, are made once about `first` and serve all fits from
/// near it: a force more or less changes them by parts in a thousand, so that each iteration still gains three digits.
class OrbitFit {
 public:
  OrbitFit(const Propagate& propagate, const OrbitStart& first, Positions measured);

  /// The start that makes the positions of `propagate` fit best; the drag scale is left as it is unless `fits_drag`.
  OrbitStart fit(const Propagate& propagate, const OrbitStart& first, bool fits_drag = true) const;

 private:
  static constexpr int kParameters = 7;
  using Parameters = Eigen::Matrix<double, kParameters, 1>;

  static OrbitStart displaced(const OrbitStart& start, const Parameters& by);

  Positions measured_;
  Eigen::Matrix<double, Eigen::Dynamic, kParameters> derivatives_;  ///< of positions, in units of the steps
};

}  // namespace vbar::truth::test
