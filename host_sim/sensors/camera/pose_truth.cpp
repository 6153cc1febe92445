#include "host_sim/sensors/camera/pose_truth.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "fsw/orbit/sun.h"
#include "host_sim/sensors/camera/true_camera.h"
#include "host_sim/twins/camera/exposure_of_truth.h"

namespace vbar::sensors {
namespace {

using Eigen::Quaterniond;
using fsw::Vector3;

constexpr double kDegree = M_PI / 180.0;
constexpr int kKeypoints = 11;

Quaterniond quaternion(const double (&q)[4]) {
  return Quaterniond(q[0], q[1], q[2], q[3]).normalized();
}

/// Rotation vector from one attitude to the other, in the axes of `from`'s right-hand frame: to = from * exp(turn).
Vector3 turn_between(const Quaterniond& from, const Quaterniond& to) {
  const Eigen::AngleAxisd turn(from.conjugate() * to);
  const double angle = turn.angle() > M_PI ? turn.angle() - 2.0 * M_PI : turn.angle();
  return angle * turn.axis();
}

void add_pnp_error(PoseRow& row, const telemetry_pose& pose, const Quaterniond& q_camera_body,
                   const Vector3& position_camera) {
  const Vector3 error = Eigen::Map<const Vector3>(pose.pnp_position_camera_m) - position_camera;
  row.pnp_error_x_m = error.x();
  row.pnp_error_y_m = error.y();
  row.pnp_error_z_m = error.z();
  row.pnp_error_deg = q_camera_body.angularDistance(quaternion(pose.pnp_q_camera_body)) / kDegree;
}

void add_attitude_error(PoseRow& row, const telemetry_pose& pose, const Quaterniond& q_camera_body,
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

}  // namespace

void append_keypoints(double exposure_s, const telemetry_pose& m, std::vector<KeypointRow>& rows) {
  for (int k = 0; k < kKeypoints; ++k) {
    KeypointRow row;
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

void add_truth(PoseRow& row, std::vector<KeypointRow>& keypoints, const telemetry_pose& pose,
               const double (&keypoints_body_m)[33], const CameraSensor& known, const mission::Spacecraft& servicer,
               const twins::TruthSnapshot& truth) {
  const twins::SpacecraftTruth* const own = truth.find(servicer.name);
  const twins::SpacecraftTruth* const target = truth.find(servicer.observes());
  if (own == nullptr || target == nullptr || !own->attitude || !target->attitude) return;
  const TrueCamera camera = true_camera(known, *own);
  const Vector3 position_camera = camera.q_camera_eci * camera.towards(*target);
  const Quaterniond q_camera_body = camera.q_camera_eci * target->attitude->q_body_eci.conjugate();
  row.range_m = position_camera.norm();
  row.sunlit = twins::camera::sunlit_fraction(target->orbit.position_eci, fsw::orbit::sun_position_gcrf(truth.time));
  if (pose.pnp_inliers > 0) add_pnp_error(row, pose, q_camera_body, position_camera);
  if (pose.filter_runs != 0 && row.images_used > 0) {
    if (pose.has_attitude != 0) add_attitude_error(row, pose, q_camera_body, target->attitude->rate_body);
    if (pose.fate == telemetry_pose::kEditKeypoints)
      row.nees = nees_of_roe(pose.a_roe_osculating_m, pose.covariance_a_roe, own->orbit, target->orbit);
  }
  for (int k = 0; k < kKeypoints; ++k) {
    KeypointRow& keypoint = keypoints[keypoints.size() - kKeypoints + static_cast<std::size_t>(k)];
    const Vector3 at_body = Eigen::Map<const Vector3>(keypoints_body_m + 3 * k);
    const auto pixel = pixel_of(known.settings, position_camera + q_camera_body * at_body);
    if (keypoint.fate == telemetry_pose::kKeypointUnusable || !pixel) continue;
    keypoint.error_x_px = static_cast<double>(keypoint.x_px) - pixel->x();
    keypoint.error_y_px = static_cast<double>(keypoint.y_px) - pixel->y();
  }
}

}  // namespace vbar::sensors
