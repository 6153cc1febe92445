#include "fsw/gnc/gnc.h"

#include "fsw/gnc/message_fields.h"
#include "fsw/math/math.h"

namespace vbar::fsw::gnc {

Gnc::Gnc(std::uint8_t spacecraft, vbar_packet_sink sink, void* sink_context)
    : inbox_(spacecraft), outbox_(spacecraft, sink, sink_context) {}

Status Gnc::step(GpsTime now) {
  if (!accepts(now)) {
    refuse(now);
    return is_usable(now) && now <= now_ ? Status::kBadSequence : Status::kOutOfRange;
  }
  resume(now);
  verify_state(now);
  const Duration gap = stepped_ ? now - now_ : Duration{};
  now_ = now;
  if (!stepped_) started_ = now;
  stepped_ = true;
  const double delay_s = seconds(gap) - seconds(promised_period_);
  faults_.check(now_, {.fault = telemetry_health::kFaultStepLate,
                       .is_detected = promised_period_.ns > 0 && delay_s > 0.5 * seconds(promised_period_),
                       .argument = delay_s});

  manage();
  navigate();
  assess();
  supervise();
  respond();
  control();
  report();

  navigation_.seal();
  inbox_.clear(now_ + inbox_.step_period());
  promised_period_ = inbox_.step_period();
  ++step_;
  return Status::kOk;
}

/// An estimate that was changed since the last step, or that the last step had to discard.
void Gnc::verify_state(GpsTime now) {
  const Integrity integrity = navigation_.verify();
  if (integrity == Integrity::kLost) restart(now);
  const int failures = navigation_.trunk().trunk().failures();
  faults_.check(now, {.fault = telemetry_health::kFaultState,
                      .is_detected = integrity != Integrity::kIntact || failures > failures_,
                      .argument = static_cast<double>(integrity)});
  failures_ = failures;
}

void Gnc::manage() {
  telecommands_.update(now_, inbox_);
  management_.update(now_, telecommands_);
  if (telecommands_.is_new<fault_command>()) {
    faults_.clear(now_, telecommands_.in_force<fault_command>()->clear);
  }
  const std::int32_t dropped = inbox_.counters().dropped_full;
  faults_.check(now_, {.fault = telemetry_health::kFaultInboxFull,
                       .is_detected = dropped > packets_dropped_,
                       .argument = static_cast<double>(dropped)});
  packets_dropped_ = dropped;
  faults_.check(now_, {.fault = telemetry_health::kFaultClock, .is_detected = false});
}

void Gnc::navigate() {
  images_.update(now_, inbox_, faults_);
  navigation_.update(now_, telecommands_, inbox_);
  navigation_.check_sources(now_, faults_);
  const NavigationState& state = navigation_.state();
  const double timeout = management_.configuration().navigation_timeout_s;
  const GpsTime last_heard = state.last_measurement > started_ ? state.last_measurement : started_;
  const double age_s = seconds(now_ - last_heard);
  faults_.check(now_, {.fault = telemetry_health::kFaultNavigationTimeout,
                       .is_detected = state.valid && age_s > timeout,
                       .argument = age_s});
  has_navigated_ = has_navigated_ || state.valid;
  const double since_start_s = seconds(now_ - started_);
  faults_.check(now_, {.fault = telemetry_health::kFaultNeverNavigated,
                       .is_detected = !has_navigated_ && since_start_s > timeout,
                       .argument = since_start_s});
}

void Gnc::assess() {
  guidance_.assess(now_, navigation_, management_);
  assessment_.is_known = false;
  const std::optional<DriftSituation> situation = guidance_.drift_situation();
  if (situation && management_.safety() != nullptr) {
    const double unmeasured_s = seconds(now_ - navigation_.state().last_measurement);
    assessment_ = assess_drift_now(*situation, unmeasured_s, *management_.safety(), retreat_);
  }
}

/// By the guard, which is independent of navigation.
void Gnc::supervise() {
  const safety_configuration* safety = management_.safety();
  if (safety == nullptr) return;
  guard_.configure({.target_size_m = safety->target_size_m,
                    .data_timeout_s = safety->data_timeout_s,
                    .data_timeout_range_m = safety->data_timeout_range_m});
  const NavigationState& state = navigation_.state();
  const double range_m = state.valid ? (state.target.position_eci - state.servicer.position_eci).norm() : 0.0;
  feed_guard(guard_, inbox_, telecommands_, attitude_, range_m);
  const TrunkNavigation& receivers = navigation_.trunk();
  feed_guard_codes(guard_, receivers.gnss(), receivers.trunk().settings().earth, range_m);
  check_verdicts(guard_.judge(now_), now_, faults_);
}

/// A drift counts as unsafe once no plan that leaves it could be flown for the delay that a retreat is allowed, or as
/// soon as a retreat after that delay would not keep the distance: in an eclipse the uncertainty of a drift grows past
/// its limit and shrinks again with the first images.
void Gnc::check_drift(const safety_configuration& safety) {
  if (!assessment_.is_known) return;
  const double keep_out = guidance_.keep_out(management_.configuration());
  const bool is_unsafe = guidance_.is_holding() && assessment_.passive_distance < keep_out;
  if (!is_unsafe) unsafe_since_.reset();
  if (is_unsafe && !unsafe_since_) unsafe_since_ = now_;
  const bool has_lasted = unsafe_since_ && seconds(now_ - *unsafe_since_) >= safety.retreat_delay_s;
  const bool must_leave = is_unsafe && assessment_.retreat_distance < safety.contact_distance_m;
  faults_.check(now_, {.fault = telemetry_health::kFaultDriftUnsafe,
                       .is_detected = has_lasted || must_leave,
                       .argument = assessment_.passive_distance});
  faults_.check(now_, {.fault = telemetry_health::kFaultCollisionProbability,
                       .is_detected = assessment_.collision_probability > safety.maximum_collision_probability,
                       .argument = assessment_.collision_probability});
}

/// Faults and what they lead to.
void Gnc::respond() {
  burns_.update(now_, inbox_, faults_);
  const safety_configuration* safety = management_.safety();
  if (safety == nullptr) return;
  check_drift(*safety);
  const bool is_demanded = faults_.demands(faults::Response::kRetreat);
  const bool was_retreating = retreat_.phase() != RetreatSequence::Phase::kNone;
  if (is_demanded) management_.retreat();
  const bool is_retreating = management_.mode() == Mode::kRetreat;
  if (is_retreating && !was_retreating) retreat_.begin();
  if (!is_retreating) retreat_.end();
  if (is_retreating) {
    retreat_.update(
        now_,
        {.is_known = guidance_.situation_known(),
         .is_demanded = is_demanded,
         .is_drift_unsafe = assessment_.is_known && assessment_.passive_distance < safety->contact_distance_m,
         .roe = guidance_.report().roe},
        management_);
  }
  faults_.check(now_, {.fault = telemetry_health::kFaultRetreat,
                       .is_detected = is_retreating,
                       .argument = math::sqrt(retreat_.burn().dv_rtn.squaredNorm())});
}

void Gnc::control() {
  const bool may_plan = management_.safety() == nullptr || !faults_.demands(faults::Response::kHold);
  guidance_.update(now_, inbox_.step_period(), navigation_, management_, retreat_, may_plan);
  for (std::size_t k = 0; k < guidance_.command_count(); ++k) {
    const CommandedBurn& commanded = guidance_.command(k);
    navigation_.expect_maneuver(commanded.maneuver_id, commanded.burn.time, commanded.burn.dv_rtn);
    const Vector3 command = command_for(commanded.burn.dv_rtn);
    burns_.expect(commanded.maneuver_id, commanded.burn.time, command);
    guard_.take_command(commanded.maneuver_id, command);
  }
  faults_.check(now_, {.fault = telemetry_health::kFaultHold,
                       .is_detected = guidance_.is_holding(),
                       .argument = static_cast<double>(guidance_.report().holds)});
}

Vector3 Gnc::command_for(const Vector3& dv_rtn) const {
  const bool is_off = (faults_.latched() & telemetry_health::kFaultBurnSize) != 0;
  return is_off ? Vector3(dv_rtn / burns_.scale().scale()) : dv_rtn;
}

void Gnc::report() {
  for (std::size_t k = 0; k < guidance_.command_count(); ++k) {
    const CommandedBurn& commanded = guidance_.command(k);
    maneuver_command message{};
    message.maneuver_id = commanded.maneuver_id;
    message.waypoint_index = commanded.waypoint_index;
    message.solver = static_cast<std::int8_t>(commanded.solver);
    copy(command_for(commanded.burn.dv_rtn), message.dv_rtn);
    outbox_.send(commanded.burn.time, message);
  }
  telecommands_.report(outbox_, step_, now_);
  report_navigation();
  if (navigation_.uses_camera()) point_camera();
  command_exposures();
  navigation_.report(outbox_, step_, now_, inbox_);
  report_control();
  report_safety();
  report_health();
  report_events();
}

}  // namespace vbar::fsw::gnc
