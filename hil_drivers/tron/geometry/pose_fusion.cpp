#include "hil_drivers/tron/geometry/pose_fusion.h"

#include <cmath>

#include <Eigen/Cholesky>

namespace vbar::tron {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d cross;
  cross << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return cross;
}

/// V of SE(3): the translation of exp([r; t]) is V t.
Matrix3d left_jacobian(const Vector3d& r) {
  const double angle = r.norm();
  const Matrix3d cross = cross_matrix(r);
  if (angle < 1e-6) return Matrix3d::Identity() + 0.5 * cross + cross * cross / 6.0;
  const double square = angle * angle;
  return Matrix3d::Identity() + (1.0 - std::cos(angle)) / square * cross +
         (angle - std::sin(angle)) / (square * angle) * cross * cross;
}

}  // namespace

Vector6 pose_log(const Isometry3d& pose) {
  const Eigen::AngleAxisd turn(pose.linear());
  Vector6 vector;
  vector.head<3>() = turn.angle() * turn.axis();
  vector.tail<3>() = left_jacobian(vector.head<3>()).partialPivLu().solve(pose.translation());
  return vector;
}

Isometry3d pose_exp(const Vector6& vector) {
  const Vector3d r = vector.head<3>();
  const double angle = r.norm();
  Isometry3d pose = Isometry3d::Identity();
  if (angle > 0.0) pose.linear() = Eigen::AngleAxisd(angle, r / angle).toRotationMatrix();
  pose.translation() = left_jacobian(r) * vector.tail<3>();
  return pose;
}

FusedPose fuse(const PoseEstimate& arms, const PoseEstimate& vicon) {
  const FusedPose arms_alone{arms, 0.0, FusionSources::kArmsAlone};
  if (!vicon.T.matrix().allFinite() || !vicon.covariance.allFinite()) return arms_alone;
  const Vector6 d = pose_log(arms.T.inverse() * vicon.T);
  // S_F S_V^-1 = S_K (S_K + S_V)^-1, and S_F = S_K - S_K (S_K + S_V)^-1 S_K, with one decomposition.
  const Eigen::LLT<Matrix6> sum(arms.covariance + vicon.covariance);
  if (sum.info() != Eigen::Success) return arms_alone;
  const Vector6 weighted = sum.solve(d);
  FusedPose fused;
  fused.chi_square = d.dot(weighted);
  if (!(fused.chi_square <= kFusionGate)) {
    fused.pose = arms;
    fused.sources = FusionSources::kArmsAlone;
    return fused;
  }
  fused.pose.T = arms.T * pose_exp(arms.covariance * weighted);
  // Joseph's form: symmetric and positive definite whatever the rounding.
  const Matrix6 gain = sum.solve(arms.covariance).transpose();
  const Matrix6 rest = Matrix6::Identity() - gain;
  fused.pose.covariance = rest * arms.covariance * rest.transpose() + gain * vicon.covariance * gain.transpose();
  return fused;
}

}  // namespace vbar::tron
