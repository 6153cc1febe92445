#include "fsw/gnc/gnc.h"

#include "fsw/gnc/telecommand_checks.h"

namespace vbar::fsw::gnc {
namespace {

// A mode that was commanded longer before the first step than this is that of a computer that has lost its state.
constexpr Duration kStaleCommand = duration_of_seconds(60);

}  // namespace

Gnc::Gnc(std::uint8_t spacecraft, vbar_packet_sink sink, void* sink_context)
    : inbox_(spacecraft), outbox_(spacecraft, sink, sink_context) {}

Status Gnc::step(GpsTime now) {
  if (!accepts(now)) {
    refuse(now);
    return messaging::is_usable(now) && now <= now_ ? Status::kBadSequence : Status::kOutOfRange;
  }
  resume(now);
  verify_state(now);
  begin_step(now);

  manage();
  navigate();
  assess();
  supervise();
  respond();
  control();
  command();
  report(outbox_);

  end_step();
  return Status::kOk;
}

void Gnc::verify_state(GpsTime now) {
  const navigation::Integrity integrity = measurements_.verify();
  if (integrity == navigation::Integrity::kLost) restart(now);
  check_state(now, integrity);
}

void Gnc::begin_step(GpsTime now) {
  const Duration gap = stepped_ ? now - now_ : Duration{};
  now_ = now;
  if (!stepped_) started_ = now;
  stepped_ = true;
  check_step_period(gap);
}

void Gnc::manage() {
  telecommands_.update(now_, inbox_, telecommand_rules());
  management_.update(now_, telecommands_);
  if (telecommands_.is_new<mode_command>()) {
    is_cautious_ = management_.safety() != nullptr && started_ - telecommands_.time_of<mode_command>() > kStaleCommand;
  }
  if (telecommands_.is_new<fault_command>()) {
    faults_.clear(now_, telecommands_.in_force<fault_command>()->clear);
  }
  check_inbox();
}

void Gnc::navigate() {
  images_.update(now_, inbox_, faults_);
  navigation_.update(now_, telecommands_, inbox_, measurements_);
  measurements_.check_sources(now_, faults_);
  has_navigated_ = has_navigated_ || navigation_.state().valid;
  check_navigation();
}

void Gnc::assess() {
  guidance_.assess(now_, navigation_, measurements_.filter(), management_);
  assessment_.is_known = false;
  const std::optional<guidance::DriftSituation> situation = guidance_.drift_situation();
  if (situation && management_.safety() != nullptr) {
    const double unmeasured_s = seconds(now_ - navigation_.state().last_measurement);
    assessment_ = guidance::assess_drift_now(*situation, unmeasured_s, *management_.safety(), retreat_);
  }
}

void Gnc::supervise() {
  const safety_configuration* safety = management_.safety();
  if (safety == nullptr) return;
  safety_monitor_.configure({.target_size_m = safety->target_size_m,
                             .data_timeout_s = safety->data_timeout_s,
                             .data_timeout_range_m = safety->data_timeout_range_m});
  const navigation::NavigationState& state = navigation_.state();
  const double range_m = state.valid ? (state.target.position_eci - state.servicer.position_eci).norm() : 0.0;
  fdir::update_safety_monitor(safety_monitor_, inbox_, telecommands_, attitude_, range_m);
  fdir::update_safety_monitor_by_codes(safety_monitor_, measurements_.gnss(), measurements_.filter().settings().earth,
                                       range_m);
  fdir::check_verdicts(safety_monitor_.judge(now_), now_, faults_);
}

void Gnc::respond() {
  burns_.update(now_, inbox_, faults_);
  const safety_configuration* safety = management_.safety();
  if (safety == nullptr) return;
  check_drift(*safety);
  const bool is_demanded = faults_.demands(faults::Response::kRetreat);
  proceed_with_caution(*safety, is_demanded);
  const bool was_retreating = retreat_.phase() != guidance::RetreatSequence::Phase::kNone;
  if (is_demanded) management_.retreat();
  const bool is_retreating = management_.mode() == guidance::Mode::kRetreat;
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
  check_retreat();
}

/// A retreat that was under way when the state was lost is unknown. The approach is therefore resumed only after
/// navigation has been valid, and no fault has demanded a retreat, for the delay that a retreat is allowed.
void Gnc::proceed_with_caution(const safety_configuration& safety, bool is_demanded) {
  if (is_cautious_) {
    if (is_demanded || !navigation_.state().valid) cautious_since_.reset();
    if (!cautious_since_ && navigation_.state().valid && !is_demanded) cautious_since_ = now_;
    is_cautious_ = !cautious_since_ || seconds(now_ - *cautious_since_) < safety.retreat_delay_s;
  }
  management_.suspend(is_cautious_);
}

void Gnc::control() {
  const bool may_plan = management_.safety() == nullptr || !faults_.demands(faults::Response::kHold);
  guidance_.update(now_, inbox_.step_period(), navigation_, management_, retreat_, may_plan);
  check_hold();
}

void Gnc::command() {
  command_maneuvers();
  if (navigation_.uses_camera()) point_camera();
  command_exposures();
}

void Gnc::report(messaging::Outbox& outbox) const {
  telecommands_.report(outbox, step_, now_);
  report_navigation(outbox);
  measurements_.report(outbox, step_, now_, inbox_);
  report_control(outbox);
  report_safety(outbox);
  report_health(outbox);
  report_events(outbox);
}

void Gnc::end_step() {
  measurements_.forget_transitions();
  faults_.forget_transitions();
  measurements_.seal();
  inbox_.clear(now_ + inbox_.step_period());
  promised_period_ = inbox_.step_period();
  ++step_;
}

}  // namespace vbar::fsw::gnc
