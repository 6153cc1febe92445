#include "host_sim/app/pose_truth.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "fsw/orbit/sun.h"
#include "host_sim/app/true_camera.h"
#include "host_sim/report/maneuver_series.h"
#include "host_sim/report/navigation_errors.h"
#include "host_sim/report/statistics.h"
#include "host_sim/twins/camera/exposure_of_truth.h"

namespace vbar::app {
namespace {

using Eigen::Quaterniond;
using fsw::Vector3;

constexpr double kDegree = M_PI / 180.0;
constexpr int kKeypoints = 11;

Quaterniond quaternion(const double (&q)[4]) {
  return Quaterniond(q[0], q[1], q[2], q[3]).normalized();
}

/// The small turn from one attitude to the other, in the axes of `from`'s right-hand frame: to = from * exp(turn).
Vector3 turn_between(const Quaterniond& from, const Quaterniond& to) {
  const Eigen::AngleAxisd turn(from.conjugate() * to);
  const double angle = turn.angle() > M_PI ? turn.angle() - 2.0 * M_PI : turn.angle();
  return angle * turn.axis();
}

void add_pnp_error(report::PoseRow& row, const telemetry_pose& pose, const Quaterniond& q_camera_body,
                   const Vector3& position_camera) {
  const Vector3 error = Eigen::Map<const Vector3>(pose.pnp_position_camera_m) - position_camera;
  row.pnp_error_x_m = error.x();
  row.pnp_error_y_m = error.y();
  row.pnp_error_z_m = error.z();
  row.pnp_error_deg = q_camera_body.angularDistance(quaternion(pose.pnp_q_camera_body)) / kDegree;
}

void add_attitude_error(report::PoseRow& row, const telemetry_pose& pose, const Quaterniond& q_camera_body,
                        const Vector3& rate_body) {
  const Vector3 turn = turn_between(q_camera_body, quaternion(pose.q_camera_body));
  row.attitude_error_deg = turn.norm() / kDegree;
  row.attitude_error_x_deg = turn.x() / kDegree;
  row.attitude_error_y_deg = turn.y() / kDegree;
  row.attitude_error_z_deg = turn.z() / kDegree;
  const Vector3 rate = Eigen::Map<const Vector3>(pose.rate_body) - rate_body;
  row.rate_error_radps = rate.norm();
  fsw::Vector6 error;
  error << turn, rate;
  row.attitude_nees = normalised_square(error, symmetric(pose.covariance_attitude));
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto is_nan = [](double value) { return std::isnan(value); };
  if (std::ranges::any_of(values, is_nan)) return std::numeric_limits<double>::quiet_NaN();  // has no place in an order
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Error' covariance^-1 error of a keypoint.
double chi_square(const report::KeypointRow& row) {
  const double xx = row.covariance_xx_px2, xy = row.covariance_xy_px2, yy = row.covariance_yy_px2;
  const double ex = *row.error_x_px, ey = *row.error_y_px;
  return (yy * ex * ex - 2.0 * xy * ex * ey + xx * ey * ey) / (xx * yy - xy * xy);
}

}  // namespace

report::PoseRow pose_row(double exposure_s, double step_s, const telemetry_pose& m) {
  report::PoseRow row;
  row.time_s = exposure_s;
  row.step_time_s = step_s;
  row.step = m.step;
  row.image = m.image;
  row.status = m.status;
  row.region_is_predicted = m.region_is_predicted;
  row.fate = m.fate;
  row.filter_runs = m.filter_runs;
  row.has_attitude = m.has_attitude;
  row.tiles_missing = m.tiles_missing;
  std::ranges::copy(m.region_px, row.region_px.begin());
  row.pnp_inliers = m.pnp_inliers;
  std::ranges::copy(m.pnp_q_camera_body, row.pnp_q_camera_body.begin());
  std::ranges::copy(m.pnp_position_camera_m, row.pnp_position_camera_m.begin());
  row.pnp_mean_square = m.pnp_mean_square;
  std::ranges::copy(m.q_camera_body, row.q_camera_body.begin());
  std::ranges::copy(m.position_camera_m, row.position_camera_m.begin());
  std::ranges::copy(m.rate_body, row.rate_body_radps.begin());
  std::ranges::copy(m.covariance_attitude, row.covariance_attitude.begin());
  std::ranges::copy(m.covariance_a_roe, row.covariance_a_roe_m2.begin());
  std::ranges::copy(m.a_roe_osculating_m, row.a_roe_osculating_m.begin());
  row.nis = m.nis;
  row.nis_degrees = m.nis_degrees;
  row.acceleration_psd = m.acceleration_psd;
  row.images_used = m.images_used;
  row.images_refused = m.images_refused;
  row.keypoints_used = m.keypoints_used;
  row.keypoints_refused = m.keypoints_refused;
  row.attitude_restarts = m.attitude_restarts;
  row.restarts = m.restarts;
  row.tiles_refused = m.tiles_refused;
  return row;
}

void append_keypoints(double exposure_s, const telemetry_pose& m, std::vector<report::KeypointRow>& rows) {
  for (int k = 0; k < kKeypoints; ++k) {
    report::KeypointRow row;
    row.time_s = exposure_s;
    row.image = m.image;
    row.keypoint = k;
    row.fate = m.keypoint_fate[k];
    row.peak = m.peak[k];
    row.x_px = m.x_px[k];
    row.y_px = m.y_px[k];
    row.covariance_xx_px2 = m.covariance_px2[3 * k];
    row.covariance_xy_px2 = m.covariance_px2[3 * k + 1];
    row.covariance_yy_px2 = m.covariance_px2[3 * k + 2];
    rows.push_back(row);
  }
}

void add_truth(report::PoseRow& row, std::vector<report::KeypointRow>& keypoints, const telemetry_pose& pose,
               const double (&keypoints_body_m)[33], const mission::Mission& mission,
               const mission::Spacecraft& servicer, const twins::TruthSnapshot& truth) {
  const twins::SpacecraftTruth* const own = truth.find(servicer.name);
  const twins::SpacecraftTruth* const target = truth.find(servicer.observes());
  if (!servicer.camera || own == nullptr || target == nullptr || !own->attitude || !target->attitude) return;
  const TrueCamera camera = true_camera(*servicer.camera, *own);
  const Vector3 position_camera = camera.q_camera_eci * camera.towards(*target);
  const Quaterniond q_camera_body = camera.q_camera_eci * target->attitude->q_body_eci.conjugate();
  row.range_m = position_camera.norm();
  row.sunlit = twins::camera::sunlit_fraction(target->orbit.position_eci, fsw::orbit::sun_position_gcrf(truth.time));
  if (pose.pnp_inliers > 0) add_pnp_error(row, pose, q_camera_body, position_camera);
  if (pose.filter_runs != 0 && row.images_used > 0) {
    if (pose.has_attitude != 0) add_attitude_error(row, pose, q_camera_body, target->attitude->rate_body);
    if (pose.fate == 2)
      row.nees = nees_of_roe(pose.a_roe_osculating_m, pose.covariance_a_roe, own->orbit, target->orbit,
                             mission.guidance.reference_semi_major_axis_m);
  }
  for (int k = 0; k < kKeypoints; ++k) {
    report::KeypointRow& keypoint = keypoints[keypoints.size() - kKeypoints + static_cast<std::size_t>(k)];
    const Vector3 at_body = Eigen::Map<const Vector3>(keypoints_body_m + 3 * k);
    const auto pixel = pixel_of(servicer.camera->settings, position_camera + q_camera_body * at_body);
    if (keypoint.fate == 0 || !pixel) continue;
    keypoint.error_x_px = static_cast<double>(keypoint.x_px) - pixel->x();
    keypoint.error_y_px = static_cast<double>(keypoint.y_px) - pixel->y();
  }
}

void summarise_poses(const report::RunRecord& record, report::Summary& summary) {
  if (record.poses.empty()) return;
  report::PoseFigures figures;
  std::vector<double> attitude_errors, nees, attitude_nees, keypoint_errors, chi_squares, lit_errors;
  for (const report::PoseRow& row : record.poses) {
    ++figures.images;
    if (row.pnp_inliers > 0) ++figures.with_pose;
    if (!(row.pnp_error_deg.value_or(0.0) <= 10.0)) ++figures.poses_over_10_deg;
    if (row.attitude_error_deg) attitude_errors.push_back(*row.attitude_error_deg);
    if (row.nees) nees.push_back(*row.nees);
    if (row.attitude_nees && row.fate == 2) attitude_nees.push_back(*row.attitude_nees);
  }
  for (const report::KeypointRow& row : record.keypoints) {
    if (!row.error_x_px) continue;
    keypoint_errors.push_back(std::hypot(*row.error_x_px, *row.error_y_px));
    chi_squares.push_back(chi_square(row));
  }
  std::size_t image = 0;
  for (const report::NavigationError& error : report::navigation_errors(record)) {
    while (image < record.poses.size() && record.poses[image].step_time_s < error.time_s) ++image;
    if (image < record.poses.size() && record.poses[image].step_time_s == error.time_s &&
        record.poses[image].sunlit.value_or(0.0) > 0.0)
      lit_errors.push_back(report::magnitude(error.position_rtn));
  }
  figures.keypoint_error_px = median(keypoint_errors);
  figures.keypoint_chi_square = median(chi_squares);
  if (!lit_errors.empty()) figures.lit_navigation_error_m = report::statistics(lit_errors);
  if (!attitude_nees.empty()) figures.attitude_nees = report::statistics(attitude_nees).mean;
  figures.attitude_restarts = record.poses.back().attitude_restarts;
  figures.restarts = record.poses.back().restarts;
  summary.pose = figures;
  if (!attitude_errors.empty()) summary.attitude_error_deg = report::statistics(attitude_errors);
  if (!nees.empty()) summary.navigation_nees = report::statistics(nees).mean;
}

}  // namespace vbar::app
