#include "tests/unit/host_sim/report/synthetic_run.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "host_sim/installation/sensor_kinds.h"

namespace vbar::report::test {
namespace {

struct PaperWaypoint {
  double time_h;
  Sextuple a_roe_m;
};

// The paper's table "End-to-end Mission ROE Waypoints".
constexpr PaperWaypoint kWaypoints[] = {
    {0.0, {-2000.0, -75000.0, 0.0, 0.0, 0.0, 0.0}},    {6.0, {-87.0, -50000.0, 0.0, 1000.0, 0.0, 1000.0}},
    {12.0, {-70.0, -25000.0, 0.0, 500.0, 0.0, 500.0}}, {18.0, {-17.0, -5000.0, 0.0, 500.0, 0.0, 500.0}},
    {24.0, {0.0, -1000.0, 0.0, 30.0, 0.0, 30.0}},      {28.0, {0.0, -600.0, 0.0, 18.0, 0.0, 18.0}},
    {32.0, {0.0, -200.0, 0.0, 6.0, 0.0, 6.0}},         {36.0, {0.0, -100.0, 0.0, 3.0, 0.0, 3.0}},
    {39.0, {-0.5, -10.0, 0.0, 2.0, 0.0, 1.0}},         {40.0, {0.0, -7.0, 1.0, 0.0, 2.0, 0.0}},
    {41.25, {0.0, -8.5, 1.0, 0.0, 1.0, 0.0}}};
constexpr int kLast = 10;

constexpr double kMeanMotion_radps = 1.0602e-3;

int leg_of(double time_h) {
  int leg = 1;
  while (leg < kLast && time_h >= kWaypoints[leg].time_h) ++leg;
  return leg;
}

Sextuple roe_at(double time_h) {
  const int leg = leg_of(time_h);
  const PaperWaypoint& from = kWaypoints[leg - 1];
  const PaperWaypoint& to = kWaypoints[leg];
  const double fraction = (time_h - from.time_h) / (to.time_h - from.time_h);
  Sextuple roe{};
  for (std::size_t k = 0; k < 6; ++k) roe[k] = from.a_roe_m[k] + fraction * (to.a_roe_m[k] - from.a_roe_m[k]);
  return roe;
}

// D'Amico's first-order map from ROE to RTN about a circular orbit.
Triple rtn_of(const Sextuple& roe, double time_s) {
  const double c = std::cos(kMeanMotion_radps * time_s);
  const double s = std::sin(kMeanMotion_radps * time_s);
  return {roe[0] - roe[2] * c - roe[3] * s, roe[1] + 2.0 * (roe[2] * s - roe[3] * c), roe[4] * s - roe[5] * c};
}

constexpr double kArcsecond = M_PI / 648000.0;

double norm(const Triple& v) {
  return std::hypot(v[0], v[1], v[2]);
}

/// Something between -1 and 1 that looks like noise.
double wobble(double time_s, double salt) {
  return std::sin(12.9898 * time_s + 78.233 * salt);
}

TruthRow truth_at(double time_s) {
  TruthRow row;
  row.time_s = time_s;
  const double angle = kMeanMotion_radps * time_s;
  row.servicer_position_eci = {7078e3 * std::cos(angle), 0.0, 7078e3 * std::sin(angle)};
  row.servicer_velocity_eci = {-7504.0 * std::sin(angle), 0.1, 7504.0 * std::cos(angle)};
  row.target_position_eci = row.servicer_position_eci;
  row.target_velocity_eci = row.servicer_velocity_eci;
  row.a_roe_mean_m = roe_at(time_s / 3600.0);
  row.relative_position_rtn = rtn_of(row.a_roe_mean_m, time_s);
  row.relative_velocity_rtn = {1e-3 * wobble(time_s, 1.0), -0.1, 1e-300};
  return row;
}

EstimateRow estimate_of(const TruthRow& truth, std::int64_t step) {
  EstimateRow row;
  row.time_s = truth.time_s;
  row.step = step;
  row.navigation_source = step < 5 ? 3 : 4;
  row.navigation_valid = step % 97 == 0 ? 0 : 1;
  const double sigma = 1e-3 * norm(truth.relative_position_rtn);
  for (std::size_t k = 0; k < 3; ++k) {
    row.relative_position_rtn[k] =
        truth.relative_position_rtn[k] + sigma * wobble(truth.time_s, static_cast<double>(k));
    row.relative_velocity_rtn[k] = truth.relative_velocity_rtn[k] + 1e-4 * wobble(truth.time_s, 7.0);
    row.sigma_rtn[k] = sigma;
    row.sigma_rtn[k + 3] = 1e-4;
  }
  const int leg = leg_of(truth.time_s / 3600.0);
  row.a_roe_mean_m = truth.a_roe_mean_m;
  row.a_roe_desired_m = kWaypoints[leg].a_roe_m;
  row.predicted_a_roe_error_m = {0.1, -0.2, 0.3, -0.4, 0.5, -0.0};
  row.mode = step < 3 ? 0 : 1;
  row.active_solver = leg <= 7 ? 0 : 1;
  row.waypoint_index = leg;
  row.planned_burns = 3;
  row.solver_status[place_of_status(waypoint::kSolverKoenigDamico)] = step > 2300 && step < 2320 ? 4 : 0;
  row.solver_status[place_of_status(waypoint::kSolverLeastSquares)] = 13;
  row.safety_status = step == 1000 ? 12 : 0;
  row.planned_dv_mps = 0.1;
  row.passive_safety_distance_m = 0.3 * norm(truth.relative_position_rtn);
  row.commanded_dv_mps = 1e-5 * truth.time_s;
  row.step_cost = 150000 + static_cast<std::uint64_t>(100000.0 * (1.0 + wobble(truth.time_s, 3.0)));
  row.stack_bytes = 21000;
  return row;
}

template <class Number, std::size_t size>
void set(Number (&field)[size], const std::array<double, size>& values) {
  std::ranges::copy(values, field);
}

sensors::GnssRow gnss_of(const EstimateRow& estimate) {
  sensors::GnssRow row;
  row.time_s = estimate.time_s;
  row.step = estimate.step;
  row.messages = static_cast<std::int32_t>(7 * estimate.step);
  if (estimate.step < 5) return row;
  row.epoch_s = estimate.time_s - 10.0;
  row.pairs = static_cast<std::int32_t>(estimate.step - 4);
  row.tracked = 30 + static_cast<std::int32_t>(estimate.step % 5);
  row.fixed = row.tracked - 1;
  row.fixes = 1 + static_cast<std::int32_t>(estimate.step / 100);
  row.obstacle = estimate.step % 7 == 0 ? telemetry_gnss::kObstacleRatio : telemetry_gnss::kObstacleNone;
  row.success_rate = 0.9999;
  row.ratio = 12.5;
  row.codes_used = row.phases_used = row.tracked;
  row.code_nis = row.tracked * (1.0 + 0.3 * wobble(row.time_s, 8.0));
  row.phase_nis = row.tracked * (1.0 + 0.3 * wobble(row.time_s, 9.0));
  std::size_t place = 0;
  for (std::size_t k = 0; k < 6; ++k) {
    place += k;
    row.covariance_rtn[place++] = estimate.sigma_rtn[k] * estimate.sigma_rtn[k];
  }
  return row;
}

TelemetryRow<telemetry_health> health_of(const EstimateRow& estimate) {
  TelemetryRow<telemetry_health> row{estimate.time_s, estimate.time_s, {}};
  row.message.step = estimate.step;
  row.message.packets_accepted = static_cast<std::int32_t>(40 * estimate.step);
  row.message.inbox_dropped = estimate.step > 100 ? 12 : 0;
  row.message.faults = telemetry_health::kFaultInboxFull;
  row.message.faults |= telemetry_health::kFaultHold;
  return row;
}

/// An image a minute; every seventh is dark, in every fiftieth the decoy is taken for the target.
sensors::ImageRow image_of(const EstimateRow& estimate) {
  sensors::ImageRow row;
  row.step = estimate.step;
  row.time_s = estimate.time_s - 60.0;
  row.step_time_s = estimate.time_s;
  row.image = static_cast<std::int32_t>(estimate.step);
  row.objects = static_cast<std::int16_t>(60 + estimate.step % 9);
  row.background_dn = 66.5;
  row.noise_dn = 1.25;
  row.images_without_stars = static_cast<std::int32_t>(estimate.step / 7);
  row.tiles_refused = 1;
  row.tiles_missing = estimate.step == 40 ? 3 : 0;
  row.range_m = 75000.0 * std::exp(-3e-5 * row.time_s);
  row.status = estimate.step % 7 == 0 ? 4 : 0;
  row.bearings_used = static_cast<std::int32_t>(estimate.step - estimate.step / 7);
  row.bearings_refused = 2;
  if (row.status != 0) return row;
  row.star_method = 2;
  row.stars = static_cast<std::int16_t>(40 + estimate.step % 5);
  row.hypotheses = 3;
  row.target_object = 5;
  row.true_object = estimate.step % 50 == 1 ? 6 : 5;
  row.chosen = estimate.step % 50 == 1 ? "decoy, \"behind\"" : "target";
  set(row.q_eci_camera, {0.5, -0.5, 0.5, 0.5});
  row.attitude_sigma = 4.0 * kArcsecond;
  set(row.bearing_eci, {0.6, -0.8, 1e-300});
  row.bearing_sigma = 12.0 * kArcsecond;
  set(row.prefit, {30.0 * kArcsecond * wobble(row.time_s, 10.0), 20.0 * kArcsecond * wobble(row.time_s, 11.0)});
  set(row.postfit, {15.0 * kArcsecond * wobble(row.time_s, 10.0), 12.0 * kArcsecond * wobble(row.time_s, 11.0)});
  row.nis = 1.0 + wobble(row.time_s, 12.0);
  row.fate = estimate.step < 40 ? telemetry_image::kEditBatch : telemetry_image::kEditFilter;
  std::ranges::fill(row.covariance_a_roe, 0.25);
  set(row.a_roe_osculating_m, estimate.a_roe_mean_m);
  row.bearing_error_x_arcsec = 2.0 + 12.0 * wobble(row.time_s, 13.0);
  row.bearing_error_y_arcsec = 12.0 * wobble(row.time_s, 14.0);
  row.attitude_error_across_arcsec = 4.0 + wobble(row.time_s, 15.0);
  row.attitude_error_roll_arcsec = 20.0 + wobble(row.time_s, 16.0);
  if (row.fate == telemetry_image::kEditFilter) row.nees = 6.0 + wobble(row.time_s, 17.0);
  return row;
}

void add_objects(RunRecord& record, const sensors::ImageRow& image) {
  for (int k = 0; k < 3; ++k)
    record.tables.rows<sensors::ObjectRow>().push_back(
        {image.time_s, image.image, k, k, k == 1 ? 32349 : 0, 712.34F + 10.0F * static_cast<float>(k), 500.5F});
}

/// An image of the close range a minute; every ninth in the dark, every fifth refused.
sensors::PoseRow pose_of(const EstimateRow& estimate) {
  sensors::PoseRow row;
  row.step = estimate.step;
  row.time_s = estimate.time_s - 3.0;
  row.step_time_s = estimate.time_s;
  row.image = static_cast<std::int32_t>(estimate.step);
  row.images_used = row.image;
  row.keypoints_used = 9 * row.image;
  row.attitude_restarts = 2;
  row.range_m = 8.0 + wobble(row.time_s, 18.0);
  row.sunlit = row.image % 9 == 0 ? 0.0 : 1.0;
  row.status = row.image % 9 == 0 ? 4 : 0;
  row.filter_runs = 1;
  if (row.status != 0) return row;
  row.fate = row.image % 5 == 0 ? 1 : 2;
  row.has_attitude = 1;
  set(row.region_px, {400.5, 250.25, 300.0});
  row.pnp_inliers = 9;
  set(row.pnp_q_camera_body, {0.5, 0.5, -0.5, 0.5});
  set(row.q_camera_body, {0.5, 0.5, -0.5, 0.5});
  set(row.pnp_position_camera_m, {0.1, -0.2, *row.range_m});
  set(row.position_camera_m, {0.1, -0.2, *row.range_m});
  row.pnp_mean_square = 1.1;
  set(row.rate_body, {0.01, -0.02, 0.005});
  std::size_t place = 0;
  for (std::size_t k = 0; k < 6; ++k) {
    place += k;
    row.covariance_attitude[place++] = k < 3 ? 4e-4 : 1e-8;
  }
  std::ranges::fill(row.covariance_a_roe, 0.125);
  set(row.a_roe_osculating_m, estimate.a_roe_mean_m);
  row.nis = 18.0 + wobble(row.time_s, 19.0);
  row.nis_degrees = 18;
  row.acceleration_psd = 1e-13;
  row.pnp_error_x_m = 0.01 * wobble(row.time_s, 20.0);
  row.pnp_error_y_m = 0.01 * wobble(row.time_s, 21.0);
  row.pnp_error_z_m = 0.05 * wobble(row.time_s, 22.0);
  row.pnp_error_deg = 3.0 + wobble(row.time_s, 23.0);
  row.attitude_error_x_deg = wobble(row.time_s, 24.0);
  row.attitude_error_y_deg = wobble(row.time_s, 25.0);
  row.attitude_error_z_deg = wobble(row.time_s, 26.0);
  row.attitude_error_deg = std::hypot(*row.attitude_error_x_deg, *row.attitude_error_y_deg, *row.attitude_error_z_deg);
  row.rate_error_radps = 1e-4;
  row.nees = 6.0 + wobble(row.time_s, 27.0);
  row.attitude_nees = 6.0 + wobble(row.time_s, 28.0);
  return row;
}

void add_keypoints(RunRecord& record, const sensors::PoseRow& pose) {
  for (int k = 0; k < 11; ++k) {
    sensors::KeypointRow row;
    row.time_s = pose.time_s;
    row.image = pose.image;
    row.keypoint = k;
    row.peak = 0.25F;
    row.x_px = 400.0F + 10.0F * static_cast<float>(k);
    row.y_px = 250.5F;
    row.covariance_xx_px2 = 1.0F;
    row.covariance_xy_px2 = 0.25F;
    row.covariance_yy_px2 = 2.0F;
    row.fate = pose.status != 0 || k == 10 ? 0 : k == 9 ? 1 : 2;
    if (row.fate != 0) {
      row.error_x_px = wobble(pose.time_s, 30.0 + k);
      row.error_y_px = 1.5 * wobble(pose.time_s, 50.0 + k);
    }
    record.tables.rows<sensors::KeypointRow>().push_back(row);
  }
}

/// A black pixel as PNG: what a picture's bytes are does not matter here, but zeros and line ends among them do.
const std::vector<std::uint8_t> kPicture{
    0x89, 'P',  'N',  'G',  '\r', '\n', 0x1A, '\n', 0,    0,    0,    0x0D, 'I',  'H',  'D',  'R',  0,
    0,    0,    1,    0,    0,    0,    1,    8,    0,    0,    0,    0,    0x3A, 0x7E, 0x9B, 0x55, 0,
    0,    0,    0x0A, 'I',  'D',  'A',  'T',  0x08, 0xD7, 0x63, 0x60, 0,    0,    0,    0x02, 0,    1,
    0xE2, 0x21, 0xBC, 0x33, 0,    0,    0,    0,    'I',  'E',  'N',  'D',  0xAE, 0x42, 0x60, 0x82};

void add_waypoints(RunRecord& record) {
  double cumulative = 0.0;
  for (int k = 0; k <= kLast; ++k) {
    WaypointRow row;
    row.index = k;
    row.time_s = 3600.0 * kWaypoints[k].time_h;
    row.a_roe_desired_m = kWaypoints[k].a_roe_m;
    row.a_roe_actual_m = kWaypoints[k].a_roe_m;
    row.desired_position_rtn = rtn_of(row.a_roe_desired_m, row.time_s);
    row.actual_position_rtn = row.desired_position_rtn;
    row.control_error_m = 0.1 * k;
    if (k > 0) row.navigation_error_m = 1.0 / (1.0 + k);
    if (k > 1) row.navigation_velocity_error_mps = 1e-4 / k;
    row.leg_dv_mps = k > 0 ? 1.0 / (k * k) : 0.0;
    cumulative += row.leg_dv_mps;
    row.cumulative_dv_mps = cumulative;
    row.leg_maneuvers = k > 0 ? 4 : 0;
    record.waypoints.push_back(row);
  }
}

void add_maneuvers(RunRecord& record) {
  for (int id = 1; id <= 40; ++id) {
    ManeuverRow row;
    row.maneuver_id = id;
    row.waypoint_index = 1 + (id - 1) / 4;
    row.solver = row.waypoint_index <= 7 ? 0 : 1;
    row.execution_time_s = 3600.0 * (kWaypoints[row.waypoint_index - 1].time_h + 0.2 * ((id - 1) % 4));
    row.command_time_s = row.execution_time_s - 60.0;
    row.accepted = id != 17;
    row.commanded_dv_rtn_mps = {0.0, 1.0 / (id * id), -0.3 / id};
    if (row.accepted) row.executed_dv_rtn_mps = row.commanded_dv_rtn_mps;
    record.maneuvers.push_back(row);
  }
}

Summary summary() {
  Summary s;
  s.mission = "synthetic";
  s.seed = 18446744073709551615ULL;
  s.complete = true;
  s.flight_computer = "zynq_qemu";
  s.flight_software = "<a \"test\" & nothing else>";
  s.navigation = "ideal";
  s.simulated_s = 148500.0;
  s.wall_s = 52.36;
  s.speed_factor = s.simulated_s / s.wall_s;
  s.navigation_error_m = MeanAndDeviation{0.0087, 0.0032};
  s.navigation_velocity_error_mps = MeanAndDeviation{2.4e-5, 1.1e-5};
  s.first_fix_s = 300.0;
  s.static_floor_m = 0.0061;
  s.navigation_nees = 5.9;
  s.bearing_error_arcsec = BearingError{14.5, 11.25, 2.5};
  s.star_attitude_error_arcsec = MeanAndDeviation{4.5, 1.5};
  s.sensor_figures["images"] = {{"images", 2476}, {"without_truth", 17}};
  s.attitude_error_deg = MeanAndDeviation{2.5, 1.25};
  s.sensor_figures["pose"] = {{"images", 136}, {"lit_navigation_error_mean_m", 0.0445}};
  s.sources = {{"servicer/gnss", "digital", 14857, 2, "no lock", 5, 0.125}};
  s.dv_mps = 3.8345;
  s.maneuvers = 39;
  s.commands_sha256 = std::string(64, 'a');
  s.telemetry_sha256 = std::string(64, 'b');
  s.health = telemetry_health{};
  s.health->inbox_dropped = 12;
  s.health->faults = telemetry_health::kFaultInboxFull;
  s.target = "target";
  s.flight_step = {.count = 2476, .max = 350000, .mean = 250000.5, .unit = "instructions", .stack_bytes_max = 21000};
  s.link = {2135034, 3, 2, 1, 4, 921600, 0.0125, 0.00625};
  s.deadlines = {5, 6, 7};
  s.wall_share = {0.12, 52.0, 0.1, 0.14, 30.5, 12.25, 0.75};
  return s;
}

}  // namespace

RunRecord synthetic_run() {
  RunRecord record;
  record.extensions = sensors::extensions();
  record.summary = summary();
  record.notes = {{60.0, "servicer/gnss", "failure", std::nullopt, "no lock"},
                  {120.0, "thruster", "magnitude_error", 0.015625, ""}};
  for (std::int64_t step = 0; step <= 2475; ++step) {
    record.truth.push_back(truth_at(60.0 * static_cast<double>(step)));
    record.estimates.push_back(estimate_of(record.truth.back(), step));
    record.tables.rows<sensors::GnssRow>().push_back(gnss_of(record.estimates.back()));
    std::get<std::vector<TelemetryRow<telemetry_health>>>(record.telemetry)
        .push_back(health_of(record.estimates.back()));
    record.tables.rows<sensors::ImageRow>().push_back(image_of(record.estimates.back()));
    if (step % 400 == 3 || step == 2404) {
      add_objects(record, record.tables.rows<sensors::ImageRow>().back());
      // The first is of a folder whose pictures have their marks in the pixels.
      record.gallery.push_back({.time_s = record.tables.rows<sensors::ImageRow>().back().time_s,
                                .image = record.tables.rows<sensors::ImageRow>().back().image,
                                .caption = "target & <decoy>",
                                .origin_x_px = step > 3 ? 80 : 0,
                                .origin_y_px = step > 3 ? 50 : 0,
                                .width_px = step > 3 ? 800 : 0,
                                .height_px = step > 3 ? 500 : 0,
                                .target_radius_px = 13.0,
                                .crop_left = step > 2340 ? 808 : 0,
                                .crop_side = step > 2340 ? 512 : 0,
                                .png = kPicture});
    }
    if (step >= 2340) {
      record.tables.rows<sensors::PoseRow>().push_back(pose_of(record.estimates.back()));
      add_keypoints(record, record.tables.rows<sensors::PoseRow>().back());
    }
    const double t = record.truth.back().time_s;
    if (step % 10 == 0) record.residuals.push_back({t, "camera, \"left\"", wobble(t, 5.0), 0.5 * wobble(t, 5.0), 0.4});
    if (step % 15 == 0) record.residuals.push_back({t, "gnss", 2.0 * wobble(t, 6.0), wobble(t, 6.0), 0.9});
  }
  for (const TruthRow& row : record.truth) {
    const double half = 0.5 * 0.01 * row.time_s;
    record.attitudes.push_back({row.time_s, "target", {std::cos(half), 0.0, std::sin(half), 0.0}, {0.0, 0.01, 0.0}});
  }
  add_waypoints(record);
  add_maneuvers(record);
  return record;
}

}  // namespace vbar::report::test
