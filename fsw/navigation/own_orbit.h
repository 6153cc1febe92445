#pragma once
// A smooth orbit of the servicer for angles-only navigation. Position noise of a metre would appear in the
// target's orbital elements, which refer to the servicer's; therefore the same positions are processed with dynamics
// of degree 20 and little process noise.

#include "fsw/core/gps_time.h"
#include "fsw/estimation/estimate.h"
#include "fsw/navigation/propagation.h"

namespace vbar::fsw::navigation {

struct OwnOrbitSettings {
  double position_sigma_m = 2.0;   ///< per axis of a position; errors of neighbours are partly common
  double acceleration_psd = 3e-9;  ///< m^2/s^3: Sun, Moon and tides, 1.5e-6 m/s^2 that vary with the orbit
};

class OwnOrbit {
 public:
  explicit OwnOrbit(const OwnOrbitSettings& settings = {}) : settings_(settings) {}

  void reset() { started_ = false; }
  /// Initialises with an orbit known to `position_sigma_m` and 0.05 m/s, 1 sigma per axis.
  void begin(const orbit::CartesianState& state);
  [[nodiscard]] bool started() const { return started_; }
  [[nodiscard]] orbit::CartesianState state() const {
    return {.position_eci = estimate_.mean().head<3>(), .velocity_eci = estimate_.mean().tail<3>()};
  }

  /// Of the inertial state, m and m/s.
  [[nodiscard]] Matrix6 covariance() const { return estimate_.head_covariance<6>(); }

  void advance(const Propagation& propagation, double dt);
  void add_impulse(const Vector3& dv_eci, double sigma);
  /// Processes a position (m, ECI); one beyond 6 sigma in an axis is refused, and the sixth consecutive refusal
  /// restarts the filter with `measured`.
  void take(const orbit::CartesianState& measured);

 private:
  OwnOrbitSettings settings_;
  bool started_ = false;
  int refused_in_a_row_ = 0;
  estimation::Estimate<6> estimate_;
};

}  // namespace vbar::fsw::navigation
