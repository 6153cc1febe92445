// report: the telemetry of a step.

#include "fsw/gnc/gnc.h"
#include "fsw/gnc/message_fields.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::gnc {
namespace {

/// Values of telemetry_pose.keypoint_fate.
std::int8_t keypoint_fate(const pose::Keypoint& seen, const navigation::KeypointUpdate& update) {
  if (update.accepted) return telemetry_pose::kKeypointUsed;
  if (update.is_usable) return telemetry_pose::kKeypointRejected;
  return seen.is_usable ? telemetry_pose::kKeypointWithoutFilter : telemetry_pose::kKeypointUnusable;
}

template <class Enumerator>
constexpr bool is_reported_as(Enumerator enumerator, int constant) {
  return static_cast<int>(enumerator) == constant;
}

// The last of each list stands for all: the lists of vbar.lcm are those of the code.
static_assert(is_reported_as(Status::kNotReady, telemetry_control::kStatusNotReady));
static_assert(is_reported_as(kFaultNeverNavigated, telemetry_health::kFaultNeverNavigated));
static_assert(is_reported_as(NavigationSource::kPose, telemetry_navigation::kSourcePose));
static_assert(is_reported_as(pose::SightingStatus::kInvalid, telemetry_pose::kStatusInvalid));

}  // namespace

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

std::optional<Pointing> Gnc::pointing_to_target() const {
  const NavigationState& state = navigation_.state();
  if (state.has_target) {
    const Result<Pointing> pointing = pointing_at(now_, state.servicer, state.target);
    return pointing.ok() ? std::optional(pointing.value()) : std::nullopt;
  }
  const auto& last_seen_rtn = navigation_.pose().last_seen_rtn();
  if (!navigation_.uses_pose() || !last_seen_rtn) return std::nullopt;
  return Pointing{.time = now_, .boresight_rtn = *last_seen_rtn};
}

/// Points at the estimated position of the target, not at that of the last image: it moves between images.
void Gnc::point_camera() {
  const std::optional<Pointing> pointing = pointing_to_target();
  if (!pointing) return;
  navigation_.expect_pointing(*pointing);
  pointing_command message{};
  copy(pointing->boresight_rtn, message.boresight_rtn);
  copy(pointing->boresight_rate_rtn, message.boresight_rate_rtn);
  outbox_.send(now_, message);
}

void Gnc::report_pose() {
  const PoseCameraNavigation& camera = navigation_.pose();
  const pose::PoseSighting& sighting = camera.sighting();
  const navigation::PoseNavigation& filter = camera.filter();
  const navigation::PoseUpdate& update = filter.last_update();
  telemetry_pose message{};
  message.step = step_;
  message.image = sighting.image;
  message.status = static_cast<std::int8_t>(sighting.status);
  message.region_is_predicted = sighting.region_is_predicted ? 1 : 0;
  message.fate = static_cast<std::int8_t>(camera.edit_status());
  message.filter_runs = filter.valid() ? 1 : 0;
  message.has_attitude = filter.has_attitude() ? 1 : 0;
  message.tiles_missing = static_cast<std::int16_t>(camera.tiles_missing());
  message.region_px[0] = sighting.region.centre_px.x();
  message.region_px[1] = sighting.region.centre_px.y();
  message.region_px[2] = sighting.region.side_px;
  for (std::size_t k = 0; k < sighting.keypoints.size(); ++k) {
    const pose::Keypoint& keypoint = sighting.keypoints[k];
    message.x_px[k] = static_cast<float>(keypoint.pixel.x());
    message.y_px[k] = static_cast<float>(keypoint.pixel.y());
    message.covariance_px2[3 * k] = static_cast<float>(keypoint.covariance_px2(0, 0));
    message.covariance_px2[3 * k + 1] = static_cast<float>(keypoint.covariance_px2(1, 0));
    message.covariance_px2[3 * k + 2] = static_cast<float>(keypoint.covariance_px2(1, 1));
    message.peak[k] = static_cast<float>(keypoint.peak);
    message.keypoint_fate[k] = keypoint_fate(keypoint, update.keypoints[k]);
  }
  if (sighting.pnp) {
    message.pnp_inliers = static_cast<std::int8_t>(sighting.pnp->inliers);
    copy_rotation(sighting.pnp->pose.R_camera_body, message.pnp_q_camera_body);
    copy(sighting.pnp->pose.position_camera_m, message.pnp_position_camera_m);
    message.pnp_mean_square = sighting.pnp->mean_square;
  }
  if (camera.estimated_pose()) {
    copy_rotation(camera.estimated_pose()->R_camera_body, message.q_camera_body);
    copy(camera.estimated_pose()->position_camera_m, message.position_camera_m);
    copy(filter.rate_body(), message.rate_body);
    copy_lower_triangle(filter.attitude_covariance(), message.covariance_attitude);
    copy_lower_triangle(filter.a_roe_covariance_m2(), message.covariance_a_roe);
    copy(filter.a_roe_m(), message.a_roe_osculating_m);
  }
  message.nis = update.nis;
  message.nis_degrees = 2 * update.used;
  message.acceleration_psd = filter.filter().acceleration_psd();
  const navigation::PoseCounters& counters = filter.counters();
  message.images_used = counters.images_used;
  message.images_refused = counters.images_refused;
  message.keypoints_used = counters.keypoints_used;
  message.keypoints_refused = counters.keypoints_refused;
  message.attitude_restarts = counters.attitudes_reset;
  message.restarts = counters.restarts;
  message.tiles_refused = inbox_.image().counts().tiles_refused;
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
