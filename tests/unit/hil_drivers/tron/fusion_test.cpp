// Fusion of two relative poses: analytic cases and the consistency of its covariance over many draws.

#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "hil_drivers/tron/geometry/pose_fusion.h"

namespace vbar::tron {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

Eigen::Isometry3d some_pose() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(2.1, Eigen::Vector3d(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  T.translation() << 0.2, -0.1, 3.4;
  return T;
}

Vector6 draw(const Matrix6& covariance, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Vector6 white;
  for (double& x : white) x = normal(random);
  return covariance.llt().matrixL() * white;
}

/// An arm: 0.05 deg and 1 mm; motion capture: 0.15 deg, 6 mm at the sides, both with correlations.
Matrix6 arm_covariance() {
  Matrix6 root = Matrix6::Zero();
  root.diagonal() << 9e-4, 9e-4, 9e-4, 1.0e-3, 1.0e-3, 1.0e-3;
  root(3, 1) = 7e-4;
  root(4, 0) = -7e-4;
  return root * root.transpose();
}

Matrix6 vicon_covariance() {
  Matrix6 root = Matrix6::Zero();
  root.diagonal() << 2.2e-3, 2.2e-3, 2.2e-3, 1.0e-3, 1.0e-3, 5.0e-4;
  root(3, 1) = 6e-3;
  root(4, 0) = -6e-3;
  return root * root.transpose();
}

TEST(Fusion, LogarithmInvertsExponential) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0.0, 0.8);
  for (int k = 0; k < 200; ++k) {
    Vector6 v;
    for (double& x : v) x = normal(random);
    if (v.head<3>().norm() > 3.0) continue;  // the logarithm is unique below pi
    EXPECT_LT((pose_log(pose_exp(v)) - v).norm(), 1e-9);
  }
  // A screw about z: a quarter turn with the translation along the chord of the circle (textbook form of SE(3)).
  Vector6 screw;
  screw << 0.0, 0.0, M_PI / 2, M_PI / 2, 0.0, 0.3;
  EXPECT_LT((pose_exp(screw).translation() - Eigen::Vector3d(1.0, 1.0, 0.3)).norm(), 1e-12);
}

TEST(Fusion, EqualCovariancesMeetHalfway) {
  const Matrix6 covariance = 1e-6 * Matrix6::Identity();
  Vector6 apart = Vector6::Zero();
  apart[3] = 2e-3;
  const FusedPose fused = fuse({some_pose(), covariance}, {some_pose() * pose_exp(apart), covariance});
  EXPECT_EQ(fused.sources, FusionSources::kBoth);
  EXPECT_LT((fused.pose.T.matrix() - (some_pose() * pose_exp(0.5 * apart)).matrix()).norm(), 1e-15);
  EXPECT_LT((fused.pose.covariance - 0.5e-6 * Matrix6::Identity()).norm(), 1e-20);
  EXPECT_NEAR(fused.chi_square, 4e-6 / 2e-6, 1e-9);
}

TEST(Fusion, AgreesWithTheFormOfInverses) {
  Vector6 d;
  d << 1e-3, -5e-4, 2e-4, 2e-3, 1e-3, -5e-4;
  const Matrix6 arm = arm_covariance(), vicon = vicon_covariance();
  const FusedPose fused = fuse({some_pose(), arm}, {some_pose() * pose_exp(d), vicon});
  ASSERT_EQ(fused.sources, FusionSources::kBoth);
  const Matrix6 expected = (arm.inverse() + vicon.inverse()).inverse();
  EXPECT_LT((fused.pose.covariance - expected).norm(), 1e-9 * expected.norm());
  const Vector6 step = expected * vicon.inverse() * d;
  EXPECT_LT((pose_log(some_pose().inverse() * fused.pose.T) - step).norm(), 1e-9 * step.norm());
}

// Mean of the normalised squared error: 6 with a standard deviation of sqrt(2 * 6 / n); five of them accepted. The gate
// rejects 5 % of the differences, which the arms alone then answer: their errors are of S_K, a little selected.
TEST(Fusion, CovarianceIsConsistentWithTheErrors) {
  std::mt19937_64 random(11);
  const Matrix6 arm = arm_covariance(), vicon = vicon_covariance();
  constexpr int kDraws = 20000;
  double sum_fused = 0.0, sum_gate = 0.0;
  int both = 0;
  for (int k = 0; k < kDraws; ++k) {
    // T_true = T exp(error), so the measured pose is T_true exp(-error).
    const Eigen::Isometry3d truth = some_pose();
    const PoseEstimate by_arms{truth * pose_exp(-draw(arm, random)), arm};
    const PoseEstimate by_vicon{truth * pose_exp(-draw(vicon, random)), vicon};
    const FusedPose fused = fuse(by_arms, by_vicon);
    sum_gate += fused.chi_square;
    if (fused.sources == FusionSources::kArmsAlone) continue;
    ++both;
    const Vector6 error = pose_log(fused.pose.T.inverse() * truth);
    sum_fused += error.dot(fused.pose.covariance.llt().solve(error));
  }
  const double tolerance = 5.0 * std::sqrt(12.0 / kDraws);
  EXPECT_NEAR(sum_gate / kDraws, 6.0, tolerance);
  EXPECT_NEAR(sum_fused / both, 6.0, tolerance);
  const double share = static_cast<double>(both) / kDraws;
  EXPECT_NEAR(share, 0.95, 5.0 * std::sqrt(0.05 * 0.95 / kDraws) + 0.001);  // 12.6 is 12.592 rounded
}

TEST(Fusion, BeyondTheGateTheArmsAreTrusted) {
  Vector6 far = Vector6::Zero();
  far[3] = 0.1;
  const PoseEstimate arms{some_pose(), arm_covariance()};
  const FusedPose fused = fuse(arms, {some_pose() * pose_exp(far), vicon_covariance()});
  EXPECT_EQ(fused.sources, FusionSources::kArmsAlone);
  EXPECT_GT(fused.chi_square, kFusionGate);
  EXPECT_EQ(fused.pose.T.matrix(), arms.T.matrix());
  EXPECT_EQ(fused.pose.covariance, arms.covariance);
}

TEST(Fusion, NotANumberOfMotionCaptureIsNotUsed) {
  const PoseEstimate arms{some_pose(), arm_covariance()};
  PoseEstimate vicon{some_pose(), vicon_covariance()};
  vicon.T.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(fuse(arms, vicon).sources, FusionSources::kArmsAlone);
  vicon = {some_pose(), vicon_covariance()};
  vicon.covariance(2, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(fuse(arms, vicon).sources, FusionSources::kArmsAlone);
}

}  // namespace
}  // namespace vbar::tron
