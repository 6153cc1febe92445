#pragma once
// The servicer's own orbit from its receiver's positions: an unscented filter on the inertial state. Metres are all it
// is asked for; what needs millimetres is relative.

#include "fsw/core/gps_time.h"
#include "fsw/estimation/estimate.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::navigation {

class OrbitFilter {
 public:
  /// Forgets everything.
  void reset() { *this = OrbitFilter{}; }

  /// A position (m, ECI) measured `early_s` before `time` (milliseconds: a receiver's clock is ahead by that), which is
  /// not before that of the last one. The second one starts the filter; one that does not fit (gate of 5 sigma an axis)
  /// is left out, and after kMostRefused of those in a row the filter starts anew.
  void take_position(GpsTime time, double early_s, const Vector3& position_eci, double sigma_m);

  /// Moves the estimate to `time`, at or after its epoch; an impulse (m/s, ECI) is added there.
  void advance_to(GpsTime time);
  void add_impulse(const Vector3& dv_eci);

  [[nodiscard]] bool started() const { return started_; }
  [[nodiscard]] GpsTime epoch() const { return epoch_; }
  [[nodiscard]] orbit::CartesianState state() const {
    return {.position_eci = estimate_.mean().head<3>(), .velocity_eci = estimate_.mean().tail<3>()};
  }

  static constexpr int kMostRefused = 5;
  /// A coast longer than this starts the filter anew.
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
