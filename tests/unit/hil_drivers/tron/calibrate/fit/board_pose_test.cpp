// The pose of the board by one image: exact corners, consistent covariance, bad starts, outliers.

#include "hil_drivers/tron/calibrate/fit/board_pose.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "hil_drivers/tron/calibrate/fit/scatter.h"

namespace vbar::tron::calibrate {
namespace {

using Eigen::Isometry3d;

LensCalibration lens() {
  return {1600, 1000, 2901.0, 2901.0, 799.5, 499.5, {-0.22, 0.51, -6e-4, -2e-4, -0.13}};
}

Isometry3d pose(double range_m, double tilt, double roll) {
  Isometry3d T = Isometry3d::Identity();
  T.linear() =
      (Eigen::AngleAxisd(tilt, Eigen::Vector3d(0.6, 0.8, 0.0)) * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  T.translation() << 0.05, -0.03, range_m;
  return T;
}

std::vector<Corner> corners(const Isometry3d& T_C_B, double sigma_px, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<Corner> result;
  for (int id = 0; id < BoardDesign{}.corner_count(); ++id)
    result.push_back({id, lens().project(T_C_B * BoardDesign{}.corner(id)) +
                              sigma_px * fsw::Vector2(normal(random), normal(random))});
  return result;
}

TEST(BoardPose, IsExactWithoutNoiseFromABadStart) {
  std::mt19937_64 random(1);
  const Isometry3d truth = pose(3.0, 0.5, 2.0);
  Isometry3d start = truth;
  start.linear() = Eigen::AngleAxisd(0.15, Eigen::Vector3d::UnitX()).toRotationMatrix() * start.linear();
  start.translation() += Eigen::Vector3d(0.1, -0.1, 0.3);
  const auto found = board_pose(BoardDesign{}, lens(), corners(truth, 0.0, random), start);
  ASSERT_TRUE(found);
  EXPECT_LT((found->T_C_B.matrix() - truth.matrix()).norm(), 1e-7);
  EXPECT_EQ(found->sigma_px, kCornerSigma_px);
}

// The other minimum of a plane: a start with the tilt reversed must not keep it.
TEST(BoardPose, OfTheWrongTiltIsLeft) {
  std::mt19937_64 random(2);
  const Isometry3d truth = pose(5.0, 0.5, 0.3), start = pose(5.0, -0.5, 0.3);
  const auto found = board_pose(BoardDesign{}, lens(), corners(truth, 0.3, random), start);
  ASSERT_TRUE(found);
  EXPECT_LT(pose_difference(truth, found->T_C_B).head<3>().norm(), 0.03);
}

// Mean of the normalised squared error over draws: 6, its deviation sqrt(12 / n); five of them, and 5 % for weights.
TEST(BoardPose, CovarianceIsConsistent) {
  std::mt19937_64 random(3);
  const Isometry3d truth = pose(3.5, 0.4, 1.0);
  double sum = 0.0;
  constexpr int kDraws = 200;
  for (int k = 0; k < kDraws; ++k) {
    const auto found = board_pose(BoardDesign{}, lens(), corners(truth, 0.6, random), truth);
    ASSERT_TRUE(found);
    const auto error = pose_difference(found->T_C_B, truth);
    sum += error.dot(found->covariance.llt().solve(error));
  }
  EXPECT_NEAR(sum / kDraws, 6.0, 5.0 * std::sqrt(12.0 / kDraws) + 0.4);
}

TEST(BoardPose, IsLittleMovedByOutliers) {
  std::mt19937_64 random(4);
  const Isometry3d truth = pose(2.5, 0.4, 1.0);
  std::vector<Corner> seen = corners(truth, 0.2, random);
  seen[7].px.x() += 40.0;
  seen[31].px.y() -= 25.0;
  const auto found = board_pose(BoardDesign{}, lens(), seen, truth);
  ASSERT_TRUE(found);
  EXPECT_LT((found->T_C_B.translation() - truth.translation()).norm(), 5e-3);
}

TEST(BoardPose, OfFewOrImpossibleCornersIsRefused) {
  std::mt19937_64 random(5);
  std::vector<Corner> seen = corners(pose(3.0, 0.2, 0.0), 0.0, random);
  seen.resize(kMinCorners - 1);
  EXPECT_FALSE(board_pose(BoardDesign{}, lens(), seen, pose(3.0, 0.2, 0.0)));
  std::vector<Corner> nan = corners(pose(3.0, 0.2, 0.0), 0.0, random);
  nan[3].px.x() = std::nan("");
  EXPECT_FALSE(board_pose(BoardDesign{}, lens(), nan, pose(3.0, 0.2, 0.0)));
}

}  // namespace
}  // namespace vbar::tron::calibrate
