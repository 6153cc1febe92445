#include "host_sim/app/flight_recorder.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "host_sim/app/image_rows.h"
#include "host_sim/app/image_truth.h"
#include "host_sim/app/pose_truth.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/report/code_names.h"
#include "host_sim/report/maneuver_series.h"
#include "host_sim/report/navigation_errors.h"
#include "host_sim/report/statistics.h"
#include "host_sim/sensors/camera/camera_kind.h"

namespace vbar::app {
namespace {

using fsw::Vector3;
using fsw::Vector6;
using fsw::orbit::CartesianState;
using fsw::orbit::QnsElements;
using report::magnitude;

report::Triple triple(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}
report::Triple triple(const double (&v)[3]) {
  return {v[0], v[1], v[2]};
}

report::Sextuple sextuple(const Vector6& v) {
  return {v(0), v(1), v(2), v(3), v(4), v(5)};
}
report::Sextuple sextuple(const double (&v)[6]) {
  return {v[0], v[1], v[2], v[3], v[4], v[5]};
}

double distance(const report::Triple& a, const report::Triple& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

QnsElements mean_elements(const CartesianState& state) {
  const auto osculating = fsw::orbit::qns_from_cartesian(state);
  if (!osculating.ok()) throw std::runtime_error("a true state is no orbit any more");
  const auto mean = fsw::orbit::mean_from_osculating(osculating.value());
  if (!mean.ok()) throw std::runtime_error("a true orbit has no mean elements");
  return mean.value();
}

}  // namespace

FlightRecorder::FlightRecorder(const mission::Mission& mission, const mission::Spacecraft& servicer,
                               report::RunRecord& record)
    : mission_(mission),
      servicer_(servicer),
      record_(record),
      gallery_(mission, servicer),
      pose_gallery_(mission, servicer) {
  const auto* const camera = mission::find_settings<sensors::CameraSensor>(servicer);
  if (camera != nullptr && camera->use == sensors::CameraNavigation::kPose)
    known_target_ = sensors::pose_configuration_of(mission, *camera, mission::data_directory());
}

void FlightRecorder::on_truth(fsw::GpsTime time, const PairTruth& truth) {
  report::TruthRow row;
  row.time_s = mission_seconds(time);
  row.servicer_position_eci = triple(truth.servicer.position_eci);
  row.servicer_velocity_eci = triple(truth.servicer.velocity_eci);
  row.target_position_eci = triple(truth.target.position_eci);
  row.target_velocity_eci = triple(truth.target.velocity_eci);
  const auto relative = fsw::orbit::relative_state_rtn(truth.servicer, truth.target);
  row.relative_position_rtn = triple(relative.position_rtn);
  row.relative_velocity_rtn = triple(relative.velocity_rtn);
  const Vector6 roe = fsw::orbit::roe_from_qns(mean_elements(truth.servicer), mean_elements(truth.target));
  row.a_roe_mean_m = sextuple(mission_.guidance.reference_semi_major_axis_m * roe);
  record_.truth.push_back(row);
}

void FlightRecorder::on_attitudes(fsw::GpsTime time, const std::vector<NamedAttitude>& attitudes) {
  for (const NamedAttitude& named : attitudes) {
    const Eigen::Quaterniond& q = named.attitude.q_body_eci;
    record_.attitudes.push_back(
        {mission_seconds(time), named.spacecraft, {q.w(), q.x(), q.y(), q.z()}, triple(named.attitude.rate_body)});
  }
}

// Control error: the true RTN position of the target minus the one that the commanded mean ROE give on the true
// servicer orbit.
void FlightRecorder::on_waypoint(const mission::Waypoint& waypoint, const PairTruth& truth) {
  const double a = mission_.guidance.reference_semi_major_axis_m;
  const QnsElements servicer_mean = mean_elements(truth.servicer);
  const auto desired = fsw::orbit::relative_state_from_mean_roe(servicer_mean, waypoint.a_roe_m / a);
  if (!desired.ok()) throw std::runtime_error("a waypoint gives no orbit about the servicer");
  const auto actual = fsw::orbit::relative_state_rtn(truth.servicer, truth.target);

  report::WaypointRow row;
  row.index = waypoint.index;
  row.time_s = mission_seconds(waypoint.time);
  row.a_roe_desired_m = sextuple(waypoint.a_roe_m);
  row.a_roe_actual_m = sextuple(a * fsw::orbit::roe_from_qns(servicer_mean, mean_elements(truth.target)));
  row.desired_position_rtn = triple(desired.value().position_rtn);
  row.actual_position_rtn = triple(actual.position_rtn);
  row.control_error_m = distance(row.desired_position_rtn, row.actual_position_rtn);
  record_.waypoints.push_back(row);
}

void FlightRecorder::on_measured(const twins::TruthSnapshot& truth) {
  constexpr std::size_t kKept = 64;
  if (mission::find_settings<sensors::CameraSensor>(servicer_) == nullptr ||
      (!measured_.empty() && measured_.back().time == truth.time))
    return;
  measured_.push_back(truth);
  if (measured_.size() > kKept) measured_.pop_front();
}

void FlightRecorder::on_answer(fsw::GpsTime time, const pil::StepResult& answer) {
  report::EstimateRow row;
  row.time_s = mission_seconds(time);
  row.step_cost = answer.report.count;
  row.stack_bytes = answer.report.stack_bytes;
  ImageTelemetry told;
  for (const pil::Packet& bytes : answer.packets) {
    const auto packet = fsw::packets::parse_packet(bytes);
    if (!packet.ok()) continue;  // hashed and logged as it came; it only has no row
    if (packet.value().header.apid == fsw::packets::Apid::kManeuverCommand) {
      on_command(time, packet.value());
    } else {
      on_telemetry(row, told, packet.value());
    }
  }
  if (told.image) on_image(row, told);
  if (told.pose) on_pose(row, told);
  record_.estimates.push_back(row);
}

void FlightRecorder::on_telemetry(report::EstimateRow& row, ImageTelemetry& told,
                                  const fsw::packets::PacketView& packet) {
  if (const auto navigation = fsw::packets::decode<telemetry_navigation>(packet); navigation.ok()) {
    const telemetry_navigation& m = navigation.value();
    row.step = m.step;
    row.navigation_source = m.source;
    row.navigation_valid = m.valid;
    row.relative_position_rtn = triple(m.relative_position_rtn);
    row.relative_velocity_rtn = triple(m.relative_velocity_rtn);
    row.sigma_rtn = sextuple(m.sigma_rtn);
    row.a_roe_mean_m = sextuple(m.a_roe_mean_m);
  } else if (const auto control = fsw::packets::decode<telemetry_control>(packet); control.ok()) {
    const telemetry_control& m = control.value();
    row.a_roe_desired_m = sextuple(m.a_roe_desired_m);
    row.predicted_a_roe_error_m = sextuple(m.predicted_a_roe_error_m);
    row.mode = m.mode;
    row.active_solver = m.active_solver;
    row.waypoint_index = m.waypoint_index;
    row.planned_burns = m.planned_burns;
    row.koenig_damico_status = m.koenig_damico_status;
    row.closed_form_status = m.closed_form_status;
    row.least_squares_status = m.least_squares_status;
    row.safety_status = m.safety_status;
    row.planned_dv_mps = m.planned_dv;
    row.passive_safety_distance_m = m.passive_safety_distance_m;
    row.commanded_dv_mps = m.commanded_dv;
  } else if (const auto gnss = fsw::packets::decode<telemetry_gnss>(packet); gnss.ok()) {
    record_.gnss.push_back(gnss_row(row.time_s, gnss.value()));
  } else if (const auto image = fsw::packets::decode<telemetry_image>(packet); image.ok()) {
    told.exposure = packet.header.time;
    told.image = image.value();
  } else if (const auto objects = fsw::packets::decode<telemetry_objects>(packet); objects.ok()) {
    told.objects = objects.value();
  } else if (const auto pose = fsw::packets::decode<telemetry_pose>(packet); pose.ok()) {
    told.exposure = packet.header.time;
    told.pose = pose.value();
  }
}

void FlightRecorder::on_image(const report::EstimateRow& step, const ImageTelemetry& told) {
  report::ImageRow row = image_row(mission_seconds(told.exposure), step.time_s, *told.image);
  const telemetry_objects* const objects =
      told.objects && told.objects->image == told.image->image ? &*told.objects : nullptr;
  const auto truth = std::ranges::find(measured_, told.exposure, &twins::TruthSnapshot::time);
  if (truth != measured_.end()) add_truth(row, *told.image, objects, mission_, servicer_, *truth);
  if (row.used != 0) append_residuals(row, record_.residuals);
  if (objects != nullptr) append_objects(row.time_s, *objects, record_.objects);
  record_.images.push_back(row);
  gallery_.on_image({told.exposure, row, objects}, record_.gallery);
}

void FlightRecorder::on_pose(const report::EstimateRow& step, const ImageTelemetry& told) {
  const double exposure_s = mission_seconds(told.exposure);
  report::PoseRow row = pose_row(exposure_s, step.time_s, *told.pose);
  append_keypoints(exposure_s, *told.pose, record_.keypoints);
  const auto truth = std::ranges::find(measured_, told.exposure, &twins::TruthSnapshot::time);
  if (truth != measured_.end() && known_target_)
    add_truth(row, record_.keypoints, *told.pose, known_target_->keypoints_body_m, mission_, servicer_, *truth);
  record_.poses.push_back(row);
  pose_gallery_.on_pose(told.exposure, *told.pose, row, record_.gallery);
}

report::GnssRow FlightRecorder::gnss_row(double time_s, const telemetry_gnss& m) const {
  report::GnssRow row;
  row.time_s = time_s;
  row.step = m.step;
  if (m.epoch_gps_ns != 0) row.epoch_s = mission_seconds(fsw::GpsTime{m.epoch_gps_ns});
  row.pairs = m.pairs;
  row.alone = m.alone;
  row.too_late = m.too_late;
  row.no_solution = m.no_solution;
  row.tracked = m.tracked;
  row.fixed = m.fixed;
  row.fixes = m.fixes;
  row.releases = m.releases;
  row.slips = m.slips;
  row.restarts = m.restarts;
  row.obstacle = report::obstacle_name(m.obstacle);
  row.success_rate = m.success_rate;
  row.ratio = m.ratio;
  row.codes_used = m.codes_used;
  row.phases_used = m.phases_used;
  row.codes_refused = m.codes_refused;
  row.phases_refused = m.phases_refused;
  row.code_nis = m.code_nis;
  row.phase_nis = m.phase_nis;
  std::ranges::copy(m.covariance_rtn, row.covariance_rtn.begin());
  row.messages = m.messages;
  row.messages_refused = m.messages_refused;
  return row;
}

void FlightRecorder::on_command(fsw::GpsTime step_time, const fsw::packets::PacketView& packet) {
  const auto command = fsw::packets::decode<maneuver_command>(packet);
  if (command.ok()) add_maneuver(step_time, packet.header.time, command.value());
}

void FlightRecorder::on_prescribed(fsw::GpsTime time, const maneuver_command& command) {
  add_maneuver(time, time, command);
}

void FlightRecorder::add_maneuver(fsw::GpsTime command_time, fsw::GpsTime burn_time, const maneuver_command& command) {
  report::ManeuverRow row;
  row.maneuver_id = command.maneuver_id;
  row.waypoint_index = command.waypoint_index;
  row.solver = command.solver;
  row.command_time_s = mission_seconds(command_time);
  row.execution_time_s = mission_seconds(burn_time);
  row.commanded_dv_rtn_mps = triple(command.dv_rtn);
  record_.maneuvers.push_back(row);
}

void FlightRecorder::on_execution(fsw::GpsTime time, const executed_maneuver& executed) {
  for (report::ManeuverRow& row : record_.maneuvers) {
    if (row.maneuver_id != executed.maneuver_id || row.execution_time_s != mission_seconds(time)) continue;
    row.accepted = executed.accepted != 0;
    row.executed_dv_rtn_mps = triple(executed.dv_rtn);
  }
}

void FlightRecorder::finish() {
  finish_navigation_errors();
  finish_legs();
  gallery_.finish(record_.gallery);
  summarise_images(record_.images, servicer_.observes(), record_.summary);
  summarise_poses(record_, record_.summary);
}

// Statistics of carrier-phase navigation are those after the first fix, as the paper's are.
void FlightRecorder::finish_navigation_errors() {
  const std::optional<double> fix_s = report::first_fix(record_);
  std::vector<double> position_errors, velocity_errors, nees;
  for (const report::NavigationError& error : report::navigation_errors(record_)) {
    const double position_error = magnitude(error.position_rtn);
    const double velocity_error = magnitude(error.velocity_rtn);
    for (report::WaypointRow& waypoint : record_.waypoints) {
      if (waypoint.time_s != error.time_s) continue;
      waypoint.navigation_error_m = position_error;
      waypoint.navigation_velocity_error_mps = velocity_error;
    }
    if (fix_s && error.time_s < *fix_s) continue;
    position_errors.push_back(position_error);
    velocity_errors.push_back(velocity_error);
    if (error.nees) nees.push_back(*error.nees);
  }
  report::Summary& summary = record_.summary;
  if (fix_s) summary.first_fix_s = *fix_s - fsw::seconds(mission_.start);
  if (!nees.empty()) summary.navigation_nees = report::statistics(nees).mean;
  if (position_errors.empty()) return;
  summary.navigation_error_m = report::statistics(position_errors);
  summary.navigation_velocity_error_mps = report::statistics(velocity_errors);
}

// A burn belongs to the leg of the waypoint it was commanded for: the last burn of a fuel-optimal leg stands at the
// waypoint's own time and stops the arrival.
void FlightRecorder::finish_legs() {
  report::Summary& summary = record_.summary;
  summary.dv_mps = 0.0;
  summary.maneuvers = 0;
  for (const report::ManeuverRow& maneuver : record_.maneuvers) {
    if (!maneuver.accepted) continue;
    const double dv = magnitude(maneuver.executed_dv_rtn_mps);
    summary.dv_mps += dv;
    ++summary.maneuvers;
    const auto leg = std::ranges::find_if(record_.waypoints, [&](const report::WaypointRow& waypoint) {
      return maneuver.waypoint_index == waypoint.index;
    });
    if (leg == record_.waypoints.end()) continue;
    leg->leg_dv_mps += dv;
    ++leg->leg_maneuvers;
  }
  double cumulative = 0.0;
  for (report::WaypointRow& waypoint : record_.waypoints) {
    cumulative += waypoint.leg_dv_mps;
    waypoint.cumulative_dv_mps = cumulative;
  }
}

}  // namespace vbar::app
