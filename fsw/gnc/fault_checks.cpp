// Fault checks of the phases of a step: what each phase has found, stated to the fault monitor.
//
// The order of the checks is that of the events in telemetry. What a fault leads to is in fsw/faults/fault_table.h.

#include "fsw/gnc/gnc.h"
#include "fsw/math/math.h"

namespace vbar::fsw::gnc {

/// Detects an estimate that was changed between two steps, or that the last step had to discard.
void Gnc::check_state(GpsTime now, navigation::Integrity integrity) {
  const int failures = measurements_.filter().failures();
  faults_.check(now, {.fault = telemetry_health::kFaultState,
                      .is_detected = integrity != navigation::Integrity::kIntact || failures > failures_,
                      .argument = static_cast<double>(integrity)});
  failures_ = failures;
}

/// Detects a step that comes later than the last tick has stated, by more than half a period.
void Gnc::check_step_period(Duration gap) {
  const double delay_s = seconds(gap) - seconds(promised_period_);
  faults_.check(now_, {.fault = telemetry_health::kFaultStepLate,
                       .is_detected = promised_period_.ns > 0 && delay_s > 0.5 * seconds(promised_period_),
                       .argument = delay_s});
}

/// Detects packets that the inbox had no room for. A step that runs has an acceptable clock.
void Gnc::check_inbox() {
  const std::int32_t dropped = inbox_.counters().dropped_full;
  faults_.check(now_, {.fault = telemetry_health::kFaultInboxFull,
                       .is_detected = dropped > packets_dropped_,
                       .argument = static_cast<double>(dropped)});
  packets_dropped_ = dropped;
  faults_.check(now_, {.fault = telemetry_health::kFaultClock, .is_detected = false});
}

/// Detects a valid estimate without recent measurements, and navigation that has had no valid estimate since the start.
void Gnc::check_navigation() {
  const navigation::NavigationState& state = navigation_.state();
  const double timeout = management_.configuration().navigation_timeout_s;
  const GpsTime last_heard = state.last_measurement > started_ ? state.last_measurement : started_;
  const double age_s = seconds(now_ - last_heard);
  faults_.check(now_, {.fault = telemetry_health::kFaultNavigationTimeout,
                       .is_detected = state.valid && age_s > timeout,
                       .argument = age_s});
  const double since_start_s = seconds(now_ - started_);
  faults_.check(now_, {.fault = telemetry_health::kFaultNeverNavigated,
                       .is_detected = !has_navigated_ && since_start_s > timeout,
                       .argument = since_start_s});
}

/// A drift counts as unsafe once no plan that leaves it could be flown for the delay that a retreat is allowed, or as
/// soon as a retreat after that delay would not keep the distance: in an eclipse the uncertainty of a drift grows past
/// its limit and shrinks again with the first images.
void Gnc::check_drift(const safety_configuration& safety) {
  if (!assessment_.is_known) return;
  const double keep_out = guidance_.keep_out(management_.configuration());
  const bool is_known = is_drift_known(safety);
  const bool is_unsafe = is_known && guidance_.is_holding() && assessment_.passive_distance < keep_out;
  if (!is_unsafe) unsafe_since_.reset();
  if (is_unsafe && !unsafe_since_) unsafe_since_ = now_;
  const bool has_lasted = unsafe_since_ && seconds(now_ - *unsafe_since_) >= safety.retreat_delay_s;
  const bool must_leave = is_unsafe && assessment_.retreat_distance < safety.contact_distance_m;
  faults_.check(now_, {.fault = telemetry_health::kFaultDriftUnsafe,
                       .is_detected = has_lasted || must_leave,
                       .argument = assessment_.passive_distance});
  faults_.check(now_,
                {.fault = telemetry_health::kFaultCollisionProbability,
                 .is_detected = is_known && assessment_.collision_probability > safety.maximum_collision_probability,
                 .argument = assessment_.collision_probability});
}

/// Distance and probability of collision of an orbit that has hardly been measured are those of ignorance, not of the
/// drift, which the ground chose. They count once the position a revolution later has been known to three sigma
/// within the contact distance, or after the delay that a retreat is allowed.
bool Gnc::is_drift_known(const safety_configuration& safety) {
  if (!assessed_since_) assessed_since_ = now_;
  has_settled_ = has_settled_ || assessment_.position_bound_m < safety.contact_distance_m ||
                 seconds(now_ - *assessed_since_) >= safety.retreat_delay_s;
  return has_settled_;
}

/// Reports mode retreat as a fault, with the size of its burn.
void Gnc::check_retreat() {
  faults_.check(now_, {.fault = telemetry_health::kFaultRetreat,
                       .is_detected = management_.mode() == guidance::Mode::kRetreat,
                       .argument = math::sqrt(retreat_.burn().dv_rtn.squaredNorm())});
}

/// Detects that no plan could be flown at the last decision of guidance.
void Gnc::check_hold() {
  faults_.check(now_, {.fault = telemetry_health::kFaultHold,
                       .is_detected = guidance_.is_holding(),
                       .argument = static_cast<double>(guidance_.report().holds)});
}

}  // namespace vbar::fsw::gnc
