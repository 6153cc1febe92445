#include "fsw/gnc/gnc.h"

#include "fsw/gnc/message_fields.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::gnc {
Gnc::Gnc(std::uint8_t spacecraft, vbar_packet_sink sink, void* sink_context)
    : inbox_(spacecraft), outbox_(spacecraft, sink, sink_context) {}

Status Gnc::step(GpsTime now) {
  const bool is_later = !stepped_ || now > now_;
  if (!is_later || !is_usable(now)) {
    faults_ |= kFaultClock;
    inbox_.clear(now_);
    return is_later ? Status::kOutOfRange : Status::kBadSequence;
  }
  now_ = now;
  stepped_ = true;

  manage();
  navigate();
  assess();
  control();
  report();

  inbox_.clear(now_ + inbox_.step_period());
  ++step_;
  return Status::kOk;
}

void Gnc::manage() {
  management_.update(now_, inbox_);
  if (inbox_.counters().dropped_full > 0) faults_ |= kFaultInboxFull;
}

void Gnc::navigate() {
  navigation_.update(now_, inbox_);
  const NavigationState& state = navigation_.state();
  const double timeout = management_.configuration().navigation_timeout_s;
  if (state.valid && seconds(now_ - state.last_measurement) > timeout) faults_ |= kFaultNavigationTimeout;
}

void Gnc::assess() {
  guidance_.assess(now_, navigation_, management_);
}

void Gnc::control() {
  guidance_.update(now_, inbox_.step_period(), navigation_, management_);
  for (std::size_t k = 0; k < guidance_.command_count(); ++k) {
    const CommandedBurn& commanded = guidance_.command(k);
    navigation_.expect_maneuver(commanded.maneuver_id, commanded.burn.time, commanded.burn.dv_rtn);
  }
  if (guidance_.report().holds > 0) faults_ |= kFaultHold;
}

void Gnc::report() {
  for (std::size_t k = 0; k < guidance_.command_count(); ++k) {
    const CommandedBurn& commanded = guidance_.command(k);
    maneuver_command message{};
    message.maneuver_id = commanded.maneuver_id;
    message.waypoint_index = commanded.waypoint_index;
    message.solver = static_cast<std::int8_t>(commanded.solver);
    copy(commanded.burn.dv_rtn, message.dv_rtn);
    outbox_.send(commanded.burn.time, message);
  }
  report_navigation();
  if (navigation_.uses_gnss()) report_gnss();
  if (navigation_.uses_camera()) {
    point_camera();
    if (navigation_.camera().has_image()) {
      report_image();
      report_objects();
    }
  }
  report_control();
  report_health();
}

void Gnc::report_navigation() {
  const NavigationState& state = navigation_.state();
  telemetry_navigation message{};
  message.step = step_;
  message.source = static_cast<std::int8_t>(state.source);
  message.valid = state.valid ? 1 : 0;
  if (state.valid) {
    message.age_s = seconds(now_ - state.last_measurement);
    copy(state.servicer.position_eci, message.servicer_position_eci);
    copy(state.servicer.velocity_eci, message.servicer_velocity_eci);
    const orbit::RelativeState relative = orbit::relative_state_rtn(state.servicer, state.target);
    copy(relative.position_rtn, message.relative_position_rtn);
    copy(relative.velocity_rtn, message.relative_velocity_rtn);
    copy(state.sigma_rtn, message.sigma_rtn);
    copy(management_.reference_semi_major_axis() * guidance_.report().roe, message.a_roe_mean_m);
  }
  outbox_.send(now_, message);
}

void Gnc::report_gnss() {
  const navigation::GnssNavigation& gnss = navigation_.gnss();
  const navigation::GnssNavigationCounters& counters = gnss.counters();
  const navigation::AmbiguityReport& ambiguities = gnss.ambiguities().report();
  const navigation::RelativeUpdate& last = gnss.last_update();
  telemetry_gnss message{};
  message.step = step_;
  message.epoch_gps_ns = gnss.epoch().ns;
  message.pairs = counters.pairs;
  message.alone = counters.alone;
  message.too_late = counters.too_late;
  message.no_solution = counters.no_solution;
  message.codes_refused = counters.codes_refused;
  message.phases_refused = counters.phases_refused;
  message.slips = counters.slips;
  message.restarts = counters.restarts;
  message.tracked = ambiguities.tracked;
  message.fixed = ambiguities.fixed;
  message.fixes = ambiguities.fixes;
  message.releases = ambiguities.releases;
  message.obstacle = static_cast<std::int8_t>(ambiguities.obstacle);
  message.success_rate = ambiguities.success_rate;
  message.ratio = ambiguities.ratio;
  message.codes_used = last.codes_used;
  message.phases_used = last.phases_used;
  message.code_nis = last.code_nis;
  message.phase_nis = last.phase_nis;
  if (gnss.valid()) {
    copy_lower_triangle(gnss.covariance_rtn(), message.covariance_rtn);
  }
  message.messages = navigation_.receivers().messages();
  message.messages_refused = navigation_.receivers().refused();
  outbox_.send(now_, message);
}

/// At where the target is thought to be, not where the last image showed it: between images it moves.
void Gnc::point_camera() {
  const NavigationState& state = navigation_.state();
  if (!state.has_target) return;
  const Result<Pointing> pointing = pointing_at(now_, state.servicer, state.target);
  if (!pointing.ok()) return;
  navigation_.expect_pointing(pointing.value());
  pointing_command message{};
  copy(pointing.value().boresight_rtn, message.boresight_rtn);
  copy(pointing.value().boresight_rate_rtn, message.boresight_rate_rtn);
  outbox_.send(now_, message);
}

void Gnc::report_image() {
  const CameraNavigation& camera = navigation_.camera();
  const angles_only::Sighting& sighting = camera.tracking().sighting();
  const navigation::AnglesOnlyNavigation& filter = camera.filter();
  telemetry_image message{};
  message.step = step_;
  message.image = sighting.image;
  message.status = static_cast<std::int8_t>(sighting.status);
  message.star_method = static_cast<std::int8_t>(sighting.star_method);
  message.tiles_missing = static_cast<std::int16_t>(sighting.tiles_missing);
  message.objects = static_cast<std::int16_t>(sighting.objects);
  message.stars = static_cast<std::int16_t>(sighting.stars);
  message.hypotheses = static_cast<std::int16_t>(sighting.hypotheses);
  message.target_object = static_cast<std::int16_t>(sighting.target);
  message.background_dn = sighting.background_dn;
  message.noise_dn = sighting.noise_dn;
  copy_rotation(sighting.R_camera_eci.transpose(), message.q_eci_camera);
  message.attitude_sigma = sighting.attitude_sigma;
  copy(sighting.bearing.direction_eci, message.bearing_eci);
  message.bearing_sigma = sighting.bearing.sigma;
  const bool is_filtered =
      camera.fate() == navigation::BearingFate::kFilter || camera.fate() == navigation::BearingFate::kRefused;
  if (is_filtered) {
    const navigation::BearingUpdate& update = filter.last_update();
    for (int axis = 0; axis < 2; ++axis) {
      message.prefit[axis] = update.prefit(axis);
      message.postfit[axis] = update.postfit(axis);
    }
    message.nis = update.nis;
  }
  message.fate = static_cast<std::int8_t>(camera.fate());
  message.filter_runs = filter.valid() ? 1 : 0;
  if (filter.has_target()) {
    copy(filter.a_roe_m(), message.a_roe_osculating_m);
    copy_lower_triangle(filter.a_roe_covariance_m2(), message.covariance_a_roe);
  }
  message.bearings_used = filter.counters().bearings_used;
  message.bearings_refused = filter.counters().bearings_refused;
  message.images_without_stars = camera.images_without_stars();
  message.tiles_refused = inbox_.image().counts().tiles_refused;
  outbox_.send(sighting.time, message);
}

void Gnc::report_objects() {
  const angles_only::AnglesOnlyTracking& tracking = navigation_.camera().tracking();
  const angles_only::Sighting& sighting = tracking.sighting();
  const auto objects = tracking.objects();
  telemetry_objects message{};
  message.step = step_;
  message.image = sighting.image;
  constexpr std::size_t kMost = sizeof message.kind / sizeof message.kind[0];
  const std::size_t count =
      static_cast<std::size_t>(sighting.objects) < kMost ? static_cast<std::size_t>(sighting.objects) : kMost;
  message.count = static_cast<std::int16_t>(count);
  for (std::size_t k = 0; k < count; ++k) {
    message.kind[k] = static_cast<std::int8_t>(sighting.kind[k]);
    message.star[k] = sighting.hipparcos[k];
    message.x_px[k] = static_cast<float>(objects[k].centroid_px.x());
    message.y_px[k] = static_cast<float>(objects[k].centroid_px.y());
  }
  outbox_.send(sighting.time, message);
}

void Gnc::report_control() {
  const GuidanceReport& guidance = guidance_.report();
  const double a = management_.reference_semi_major_axis();
  telemetry_control message{};
  message.step = step_;
  message.mode = static_cast<std::int8_t>(management_.mode());
  message.active_solver = static_cast<std::int8_t>(guidance.active_solver);
  message.koenig_damico_status = static_cast<std::int8_t>(guidance.koenig_damico);
  message.closed_form_status = static_cast<std::int8_t>(guidance.closed_form);
  message.least_squares_status = static_cast<std::int8_t>(guidance.least_squares);
  message.safety_status = static_cast<std::int8_t>(guidance.safety);
  message.waypoint_index = guidance.waypoint_index;
  copy(a * guidance.roe_desired, message.a_roe_desired_m);
  copy(a * guidance.predicted_roe_error, message.predicted_a_roe_error_m);
  const control::Plan& plan = guidance_.plan();
  message.planned_burns = static_cast<std::int32_t>(plan.count);
  message.planned_dv = plan.total_dv();
  message.next_burn_gps_ns = plan.count > 0 ? plan.burns[0].time.ns : 0;
  message.passive_safety_distance_m = guidance.passive_safety_distance;
  message.commanded_dv = guidance_.commanded_dv();
  message.commanded_maneuvers = guidance_.commanded_maneuvers();
  outbox_.send(now_, message);
}

void Gnc::report_health() {
  const PacketCounters& packets = inbox_.counters();
  const GuidanceReport& guidance = guidance_.report();
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
  message.outbox_dropped = outbox_.dropped();
  message.solver_fallbacks = guidance.solver_fallbacks;
  message.plans_unsafe = guidance.plans_unsafe;
  message.holds = guidance.holds;
  message.faults = faults_;
  outbox_.send(now_, message);
}

}  // namespace vbar::fsw::gnc
