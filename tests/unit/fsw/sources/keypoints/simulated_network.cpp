#include <cmath>

#include <Eigen/Dense>

#include "fsw/math/math.h"
#include "tests/unit/fsw/sources/keypoints/close_flight.h"

namespace vbar::test {
namespace {

using fsw::Matrix3;
using fsw::Vector2;
using fsw::Vector3;
using fsw::Vector6;
namespace nav = fsw::navigation;
namespace pose = fsw::pose;

constexpr double kDegree = fsw::math::kDegree;
constexpr double kArcsec = kDegree / 3600.0;

Matrix3 turn(const Vector3& by) {
  const double angle = by.norm();
  return angle > 0.0 ? Eigen::AngleAxisd(angle, by / angle).toRotationMatrix() : Matrix3(Matrix3::Identity());
}

/// z to the target, turned about it by the orbit's normal, off by a little.
Matrix3 camera_to(const fsw::orbit::CartesianState& servicer, const fsw::orbit::CartesianState& target) {
  const Vector3 z = (target.position_eci - servicer.position_eci).normalized();
  const Vector3 x = z.cross(servicer.position_eci).normalized();
  Matrix3 R_camera_eci;
  R_camera_eci << x.transpose(), z.cross(x).transpose(), z.transpose();
  return R_camera_eci;
}

}  // namespace

SimulatedNetwork::SimulatedNetwork(const CloseFlight& flight, const std::vector<nav::AttitudeState>& attitudes,
                                   const KeypointErrors& errors, unsigned seed)
    : flight_(flight), attitudes_(attitudes), errors_(errors), random_(seed) {
  attitude_bias_ = 0.7 * errors.attitude_arcsec * kArcsec * normal3();
  gnss_slow_ = normal3();
  for (Vector2& lasting : lasting_) lasting = normal3().head<2>();
  for (nav::Burn burn : flight.burns) {
    burn.dv_rtn += errors.burn_relative * burn.dv_rtn.norm() * normal3();
    known_burns_.push_back(burn);
  }
}

const MeasuredEpoch& SimulatedNetwork::measure(std::size_t index, const Eigen::Quaterniond& turned) {
  const CloseEpoch& truth = flight_.epochs[index];
  epoch_ = {};
  epoch_.time = truth.time;
  epoch_.sun_eci = truth.sun_eci;
  const double keep = std::exp(-kImagePeriod_s / 600.0);
  gnss_slow_ = keep * gnss_slow_ + std::sqrt(1.0 - keep * keep) * normal3();
  epoch_.servicer_position_eci = truth.servicer.position_eci + gnss_slow_ + 0.5 * normal3();

  const Matrix3 R_camera_eci =
      turn(errors_.pointing_deg * kDegree * normal3()) * camera_to(truth.servicer, truth.target);
  epoch_.R_camera_eci = turn(attitude_bias_ + 0.7 * errors_.attitude_arcsec * kArcsec * normal3()) * R_camera_eci;
  pose::TargetPose seen;
  seen.R_camera_body = R_camera_eci * (attitudes_[index].q_eci_body * turned).toRotationMatrix();
  seen.position_camera_m =
      R_camera_eci * (truth.target.position_eci - truth.servicer.position_eci) - camera_.position_camera_m;
  see_keypoints(seen);
  if (errors_.has_dark && !truth.is_target_lit) return epoch_;
  epoch_.keypoints = &keypoints_;
  solve_pose(seen);
  return epoch_;
}

void SimulatedNetwork::see_keypoints(const pose::TargetPose& seen) {
  const double keep = std::exp(-kImagePeriod_s / errors_.lasting_time_s);
  const double lasting_sigma = errors_.sigma_px * std::sqrt(errors_.lasting_share);
  const double white_sigma = errors_.sigma_px * std::sqrt(1.0 - errors_.lasting_share);
  const auto& camera = camera_.optics;
  const auto centre = fsw::imaging::pixel_of(camera, seen.position_camera_m);
  for (std::size_t k = 0; k < keypoints_.size(); ++k) {
    const Vector2 renewed = normal3().head<2>();
    const Vector2 white = normal3().head<2>();
    const Vector2 stray(uniform() - 0.5, uniform() - 0.5);
    const double chance = uniform();
    lasting_[k] = keep * lasting_[k] + std::sqrt(1.0 - keep * keep) * renewed;
    const auto pixel = fsw::imaging::pixel_of(camera, seen.position_camera_m + seen.R_camera_body * camera_.shape[k]);
    pose::Keypoint& keypoint = keypoints_[k];
    keypoint.is_usable = pixel.ok() && centre.ok() && chance > errors_.unseen_share;
    if (!keypoint.is_usable) continue;
    is_stray_[k] = chance > 1.0 - errors_.outlier_share;
    keypoint.pixel = pixel.value() + lasting_sigma * lasting_[k] + white_sigma * white +
                     errors_.stretch * (pixel.value() - centre.value());
    if (is_stray_[k]) keypoint.pixel = centre.value() + 250.0 * stray;
    keypoint.covariance_px2 = errors_.told_px * errors_.told_px * fsw::Matrix2::Identity();
    keypoint.peak = 0.5;
  }
}

/// As perspective n points would: the pose of least squares of the keypoints that are none of the strays, from the
/// truth on; at times turned half about.
void SimulatedNetwork::solve_pose(const pose::TargetPose& truth) {
  constexpr double kStep = 1e-6;
  const auto& camera = camera_.optics;
  pose::TargetPose pose = truth;
  pose::PnpSolution solution;
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  for (int round = 0; round < 4; ++round) {
    normal.setZero();
    Vector6 right = Vector6::Zero();
    solution.inliers = 0;
    for (std::size_t k = 0; k < keypoints_.size(); ++k) {
      solution.is_inlier[k] = keypoints_[k].is_usable && !is_stray_[k];
      if (!solution.is_inlier[k]) continue;
      ++solution.inliers;
      const auto predicted = [&](const Vector6& change) -> Vector2 {
        const Vector3 point =
            turn(change.head<3>()) * pose.R_camera_body * camera_.shape[k] + pose.position_camera_m + change.tail<3>();
        return fsw::imaging::pixel_of(camera, point).value();
      };
      Eigen::Matrix<double, 2, 6> slope;
      for (int i = 0; i < 6; ++i) {
        slope.col(i) = (predicted(kStep * Vector6::Unit(i)) - predicted(-kStep * Vector6::Unit(i))) / (2.0 * kStep);
      }
      normal += slope.transpose() * slope;
      right += slope.transpose() * (keypoints_[k].pixel - predicted(Vector6::Zero()));
    }
    if (solution.inliers < 6) return;
    const Vector6 change = normal.ldlt().solve(right);
    pose.R_camera_body = turn(change.head<3>()) * pose.R_camera_body;
    pose.position_camera_m += change.tail<3>();
  }
  if (uniform() < errors_.flip_share) {
    const int axis = static_cast<int>(3.0 * uniform());
    pose.R_camera_body = pose.R_camera_body * turn(M_PI * Vector3::Unit(axis));
  }
  solution.pose = pose;
  solution.covariance = errors_.told_px * errors_.told_px * normal.inverse();
  solution.mean_square = 1.0;
  epoch_.pnp = solution;
}

}  // namespace vbar::test
