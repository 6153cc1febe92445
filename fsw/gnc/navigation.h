#pragma once
// navigate: the state of servicer and target at the step's time, from measurements folded in at their own times and own
// maneuvers. Ideal navigation (true states in a packet) is the first source; between measurements the state coasts under J2.

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/gnc/inbox.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::gnc {

enum class NavigationSource : std::int8_t { kNone = 0, kPropagated = 1, kIdeal = 2 };

/// What navigation knows at `epoch`.
struct NavigationState {
  bool valid = false;
  NavigationSource source = NavigationSource::kNone;
  GpsTime epoch;
  GpsTime last_measurement;
  orbit::CartesianState servicer;
  orbit::CartesianState target;
  /// 1 sigma of the relative position (m) and velocity (m/s) in the servicer's RTN.
  Vector6 sigma_rtn = Vector6::Zero();
};

class Navigation {
 public:
  /// Brings the state to `now`. Entries tagged after `now` or not after the last measurement are counted as unusable.
  void update(GpsTime now, Inbox& inbox);

  [[nodiscard]] const NavigationState& state() const { return state_; }

  /// 1 sigma of a * ROE (m, six components) that `sigma_rtn` amounts to; the linear near-circular map, `servicer_mean` at epoch.
  [[nodiscard]] Vector6 sigma_a_roe_m(const orbit::QnsElements& servicer_mean) const;

 private:
  void fold_in(GpsTime time, const ideal_navigation& measurement);
  void propagate_to(GpsTime time);
  void apply_own_maneuver(const executed_maneuver& maneuver);

  NavigationState state_;
};

}  // namespace vbar::fsw::gnc
