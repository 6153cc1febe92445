#pragma once
// The servicer's orbit as angles-only navigation wants it: smooth. Positions that jitter by a metre would make the
// target's orbital elements, which stand on the servicer's, jitter with them; so here the same positions meet dynamics
// of degree 20 and little process noise.

#include "fsw/core/gps_time.h"
#include "fsw/estimation/estimate.h"
#include "fsw/navigation/propagation.h"

namespace vbar::fsw::navigation {

struct OwnOrbitSettings {
  double position_sigma_m = 2.0;   ///< of each axis of a position given; neighbours share part of their error
  double acceleration_psd = 3e-9;  ///< m^2/s^3: Sun, Moon and tides, 1.5e-6 m/s^2 that turn with the orbit
};

class OwnOrbit {
 public:
  explicit OwnOrbit(const OwnOrbitSettings& settings = {}) : settings_(settings) {}

  void reset() { started_ = false; }
  /// Begins with an orbit known to `position_sigma_m` and a hundredth of that a second.
  void begin(const orbit::CartesianState& state);
  [[nodiscard]] bool started() const { return started_; }
  [[nodiscard]] orbit::CartesianState state() const {
    return {.position_eci = estimate_.mean().head<3>(), .velocity_eci = estimate_.mean().tail<3>()};
  }

  /// Of the inertial state, m and m/s.
  [[nodiscard]] Matrix6 covariance() const { return estimate_.head_covariance<6>(); }

  void advance(const Propagation& propagation, double dt);
  void add_impulse(const Vector3& dv_eci, double sigma);
  /// Folds a position in (m, ECI); one beyond 6 sigma an axis is left out, and the sixth of those in a row makes the
  /// filter begin anew with `measured`.
  void take(const orbit::CartesianState& measured);

 private:
  OwnOrbitSettings settings_;
  bool started_ = false;
  int refused_in_a_row_ = 0;
  estimation::Estimate<6> estimate_;
};

}  // namespace vbar::fsw::navigation
