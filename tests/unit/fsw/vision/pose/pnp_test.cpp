// Poses from keypoints with outliers and noise of known size; what cannot be a pose.

#include "fsw/vision/pose/pnp.h"

#include <algorithm>
#include <limits>
#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "tests/support/sanitizers.h"
#include "tests/support/tango_view.h"

namespace vbar::fsw::pose {
namespace {

Result<PnpSolution> solve(const Keypoints& keypoints, const PnpSettings& settings = {}) {
  return solve_pnp(keypoints, test::tango_shape(), test::close_camera(), settings, 1);
}

/// Three of eleven keypoints anywhere on the target's image but not within 15 px of where they are.
TEST(Pnp, ThreeOutliersOfEleven) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int solved = 0;
  int all_right = 0;
  constexpr int kProblems = vbar::test::share_under_sanitizers(300);
  for (int n = 0; n < kProblems; ++n) {
    const TargetPose truth = test::random_pose(random, 4.0, 15.0);
    Keypoints keypoints = test::seen_keypoints(truth, 1.0, 1.0, random);
    std::array<std::size_t, pose::kKeypoints> order{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
    std::shuffle(order.begin(), order.end(), random);
    const double reach = 0.6 * 1450.0 / truth.position_camera_m.z();
    for (int k = 0; k < 3; ++k) {
      Vector2& pixel = keypoints[order[static_cast<std::size_t>(k)]].pixel;
      const Vector2 right = pixel;
      while ((pixel - right).norm() < 15.0) pixel = right + reach * Vector2(uniform(random), uniform(random));
    }
    const Result<PnpSolution> found = solve(keypoints);
    if (!found.ok()) continue;
    ++solved;
    bool is_right = true;
    for (std::size_t k = 0; k < 11; ++k) is_right = is_right && found.value().is_inlier[order[k]] == (k >= 3);
    // An inlier of 1 px noise lies beyond 3 sigma once in 90: one lost of eight is no mistake
    const auto lost = std::count(found.value().is_inlier.begin(), found.value().is_inlier.end(), true);
    bool holds_outlier = false;
    for (std::size_t k = 0; k < 3; ++k) holds_outlier = holds_outlier || found.value().is_inlier[order[k]];
    all_right += !holds_outlier && lost >= 7 ? 1 : 0;
  }
  EXPECT_EQ(solved, kProblems);
  EXPECT_GE(all_right, kProblems - 3);
}

/// Errors over their covariance are chi-square of 6 degrees: mean 6, of n within sqrt(12 / n) (1 sigma).
TEST(Pnp, CovarianceIsThatOfTheErrors) {
  std::mt19937_64 random(4);
  constexpr int kProblems = vbar::test::share_under_sanitizers(1000);
  double sum = 0.0;
  double fit = 0.0;
  int beyond = 0;
  PnpSettings settings;
  settings.inlier_sigmas = 6.0;  // hardly a keypoint is left out, which would cut the errors' tails
  for (int n = 0; n < kProblems; ++n) {
    const TargetPose truth = test::random_pose(random, 5.0, 13.0);
    const Result<PnpSolution> found = solve(test::seen_keypoints(truth, 0.5, 0.5, random), settings);
    ASSERT_TRUE(found.ok());
    const PnpSolution& s = found.value();
    Vector6 error;
    error << test::turn_between(s.pose.R_camera_body, truth.R_camera_body),
        truth.position_camera_m - s.pose.position_camera_m;
    const Eigen::LLT<Eigen::Matrix<double, 6, 6>> llt(s.covariance);
    const double square = error.dot(Vector6(llt.solve(error)));
    sum += square;
    fit += s.mean_square;
    beyond += square > 16.812 ? 1 : 0;  // once in a hundred
  }
  // Four sigmas either way
  EXPECT_NEAR(sum / kProblems, 6.0, 4.0 * std::sqrt(12.0 / kProblems));
  EXPECT_NEAR(fit / kProblems, 1.0, 4.0 * std::sqrt(2.0 / 16.0 / kProblems));
  EXPECT_LE(beyond, 10 + 13);
}

TEST(Pnp, KeypointsInAPlaneAreEnough) {
  std::mt19937_64 random(5);
  PnpSettings four;
  four.min_inliers = 4;
  for (int n = 0; n < 200; ++n) {
    const TargetPose truth = test::random_pose(random, 5.0, 13.0);
    Keypoints keypoints = test::seen_keypoints(truth, 0.0, 1.0, random);
    for (std::size_t k = 4; k < keypoints.size(); ++k) keypoints[k].is_usable = false;  // the top panel's corners
    const Result<PnpSolution> found = solve(keypoints, four);
    ASSERT_TRUE(found.ok()) << n;
    EXPECT_LT(test::turn_between(found.value().pose.R_camera_body, truth.R_camera_body).norm(), 1e-6) << n;
  }
}

TEST(Pnp, SameSeedSameBits) {
  std::mt19937_64 random(6);
  Keypoints keypoints = test::seen_keypoints(test::random_pose(random, 5.0, 13.0), 1.0, 1.0, random);
  keypoints[3].pixel.x() += 40.0;
  const PnpSolution a = solve(keypoints).value();
  const PnpSolution b = solve(keypoints).value();
  EXPECT_EQ(a.pose.R_camera_body, b.pose.R_camera_body);
  EXPECT_EQ(a.pose.position_camera_m, b.pose.position_camera_m);
  EXPECT_FALSE(a.is_inlier[3]);
}

TEST(Pnp, WhatIsNoPose) {
  std::mt19937_64 random(7);
  const Keypoints good = test::seen_keypoints(test::random_pose(random, 8.0, 9.0), 0.1, 1.0, random);
  Keypoints few = good;
  for (std::size_t k = 5; k < few.size(); ++k) few[k].is_usable = false;
  EXPECT_EQ(solve(few).status(), Status::kNotReady);

  Keypoints broken = good;
  for (std::size_t k = 0; k < 6; ++k) broken[k].pixel.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(solve(broken).status(), Status::kNotReady);
  broken = good;
  for (std::size_t k = 0; k < 6; ++k) broken[k].covariance_px2(0, 0) = -1.0;
  EXPECT_EQ(solve(broken).status(), Status::kNotReady);

  PnpSettings far;
  far.nearest_m = 20.0;
  EXPECT_EQ(solve(good, far).status(), Status::kOutOfRange);
  PnpSettings strict;
  strict.max_mean_square = 1e-6;
  EXPECT_EQ(solve(good, strict).status(), Status::kDidNotConverge);

  Keypoints one_point = good;
  for (Keypoint& keypoint : one_point) keypoint.pixel = {400.0, 300.0};
  EXPECT_FALSE(solve(one_point).ok());
}

/// Keypoints anywhere, as a network says of what is not the target: six agree by chance in few.
TEST(Pnp, KeypointsWithoutATargetAgreeOnNothing) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int poses = 0;
  for (int n = 0; n < vbar::test::share_under_sanitizers(300); ++n) {
    Keypoints keypoints = test::seen_keypoints(test::random_pose(random, 8.0, 9.0), 0.0, 1.5, random);
    for (Keypoint& keypoint : keypoints)
      keypoint.pixel = Vector2(480.0, 300.0) + 90.0 * Vector2(uniform(random), uniform(random));
    poses += solve(keypoints).ok() ? 1 : 0;
  }
  EXPECT_LE(poses, 3);
}

}  // namespace
}  // namespace vbar::fsw::pose
