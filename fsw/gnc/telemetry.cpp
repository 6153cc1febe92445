// report: the telemetry of a step. Nothing of the state changes.

#include "fsw/gnc/gnc.h"
#include "fsw/messaging/message_fields.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::gnc {
namespace {

template <class Enumerator>
constexpr bool is_reported_as(Enumerator enumerator, int constant) {
  return static_cast<int>(enumerator) == constant;
}

// The last value stands for all of its list: the lists of vbar.lcm are those of the code.
static_assert(is_reported_as(Status::kNotReady, telemetry_control::kStatusNotReady));
static_assert(is_reported_as(navigation::NavigationSource::kPose, telemetry_navigation::kSourcePose));

}  // namespace

void Gnc::report_navigation(messaging::Outbox& outbox) const {
  const navigation::NavigationState& state = navigation_.state();
  telemetry_navigation message{};
  message.step = step_;
  message.source = static_cast<std::int8_t>(state.source);
  message.valid = state.valid ? 1 : 0;
  if (state.valid) {
    message.age_s = seconds(now_ - state.last_measurement);
    messaging::copy(state.servicer.position_eci, message.servicer_position_eci);
    messaging::copy(state.servicer.velocity_eci, message.servicer_velocity_eci);
    const orbit::RelativeState relative = orbit::relative_state_rtn(state.servicer, state.target);
    messaging::copy(relative.position_rtn, message.relative_position_rtn);
    messaging::copy(relative.velocity_rtn, message.relative_velocity_rtn);
    messaging::copy(state.sigma_rtn, message.sigma_rtn);
    messaging::copy(management_.reference_semi_major_axis() * guidance_.report().roe, message.a_roe_mean_m);
  }
  outbox.send(now_, message);
}

void Gnc::report_control(messaging::Outbox& outbox) const {
  const guidance::GuidanceReport& guidance = guidance_.report();
  const double a = management_.reference_semi_major_axis();
  telemetry_control message{};
  message.step = step_;
  message.mode = static_cast<std::int8_t>(management_.mode());
  message.active_solver = static_cast<std::int8_t>(guidance.active_solver);
  control::any_solver([&]<class Entry>(std::size_t place) {
    message.*Entry::kStatus = static_cast<std::int8_t>(guidance.status[place]);
    return false;
  });
  message.safety_status = static_cast<std::int8_t>(guidance.safety);
  message.waypoint_index = guidance.waypoint_index;
  messaging::copy(a * guidance.roe_desired, message.a_roe_desired_m);
  messaging::copy(a * guidance.predicted_roe_error, message.predicted_a_roe_error_m);
  const control::Plan& plan = guidance_.plan();
  message.planned_burns = static_cast<std::int32_t>(plan.count);
  message.planned_dv = plan.total_dv();
  message.next_burn_gps_ns = plan.count > 0 ? plan.burns[0].time.ns : 0;
  message.passive_safety_distance_m = guidance.passive_safety_distance;
  message.commanded_dv = guidance_.commanded_dv();
  message.commanded_maneuvers = guidance_.commanded_maneuvers();
  outbox.send(now_, message);
}

void Gnc::report_safety(messaging::Outbox& outbox) const {
  if (management_.safety() == nullptr) return;
  telemetry_safety message{};
  message.step = step_;
  message.phase = static_cast<std::int8_t>(retreat_.phase());
  message.choice = static_cast<std::int8_t>(retreat_.burn().choice);
  messaging::copy(retreat_.burn().dv_rtn, message.retreat_dv_rtn);
  message.retreat_distance_m = assessment_.retreat_distance;
  message.passive_distance_m = assessment_.passive_distance;
  message.collision_probability = assessment_.collision_probability;
  message.collision_probability_in_plane = assessment_.collision_probability_in_plane;
  message.burn_scale = burns_.scale().scale();
  message.burn_scale_sigma = burns_.scale().sigma();
  const fdir::RangeFilter& range = safety_monitor_.range();
  if (range.is_known()) {
    message.guard_range_m = range.range_m(now_);
    message.guard_range_rate = range.range_rate(now_);
    message.guard_age_s = safety_monitor_.seen() ? seconds(now_ - *safety_monitor_.seen()) : 0.0;
  }
  outbox.send(now_, message);
}

void Gnc::report_health(messaging::Outbox& outbox) const {
  const messaging::PacketCounters& packets = inbox_.counters();
  const guidance::GuidanceReport& guidance = guidance_.report();
  telemetry_health message{};
  message.step = step_;
  message.packets_accepted = packets.accepted;
  message.rejected_checksum = packets.rejected_checksum;
  message.rejected_type = packets.rejected_type;
  message.rejected_length = packets.rejected_length;
  message.rejected_content = packets.rejected_content;
  message.rejected_time = packets.rejected_time;
  message.rejected_other = packets.rejected_other;
  message.inbox_dropped = packets.dropped_full;
  message.outbox_dropped = outbox.dropped();
  message.solver_fallbacks = guidance.solver_fallbacks;
  message.plans_unsafe = guidance.plans_unsafe;
  message.holds = guidance.holds;
  message.faults = faults_.latched();
  message.faults_present = faults_.present();
  outbox.send(now_, message);
}

void Gnc::report_events(messaging::Outbox& outbox) const {
  for (const faults::Transition& transition : faults_.transitions()) {
    telemetry_event event{};
    event.step = step_;
    event.event = transition.event;
    event.severity = transition.severity;
    event.device = transition.device;
    event.fault = transition.fault;
    event.argument = transition.argument;
    outbox.send(transition.time, event);
  }
}

}  // namespace vbar::fsw::gnc
