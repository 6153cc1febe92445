#pragma once
// The servicer's own orbit from its receiver's positions: an unscented filter on the inertial state. Accuracy of metres
// is sufficient; only the relative orbit requires millimetres.

#include "fsw/core/gps_time.h"
#include "fsw/estimation/estimate.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::navigation {

class OrbitFilter {
 public:
  /// Resets the filter.
  void reset() { *this = OrbitFilter{}; }

  /// A position (m, ECI) measured `early_s` before `time` (milliseconds: the offset of the receiver clock), which is
  /// not before that of the last one. The second one initialises the filter; one that fails the gate (5 sigma per axis)
  /// is refused, and after kMaxRefused consecutive refusals the filter restarts.
  void take_position(GpsTime time, double early_s, const Vector3& position_eci, double sigma_m);

  /// Propagates the estimate to `time`, at or after its epoch; an impulse (m/s, ECI) is added there.
  void advance_to(GpsTime time);
  void add_impulse(const Vector3& dv_eci);

  [[nodiscard]] bool started() const { return started_; }
  [[nodiscard]] GpsTime epoch() const { return epoch_; }
  [[nodiscard]] orbit::CartesianState state() const {
    return {.position_eci = estimate_.mean().head<3>(), .velocity_eci = estimate_.mean().tail<3>()};
  }

  static constexpr int kMaxRefused = 5;
  /// A propagation longer than this restarts the filter.
  static constexpr Duration kLongestCoast = duration_of_seconds(3600);

 private:
  void begin(GpsTime time, double early_s, const Vector3& position_eci, double sigma_m);

  bool has_first_ = false;
  bool started_ = false;
  GpsTime epoch_;
  Vector3 first_position_eci_ = Vector3::Zero();
  double first_early_s_ = 0.0;
  estimation::Estimate<6> estimate_;
  int refused_in_a_row_ = 0;
};

}  // namespace vbar::fsw::navigation
