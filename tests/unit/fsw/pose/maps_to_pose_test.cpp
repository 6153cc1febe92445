// From maps to the pose: Gaussian maps around where Tango's keypoints are, as a network that makes errors of a known
// size would give them.

#include <cmath>
#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "fsw/pose/heatmap.h"
#include "fsw/pose/pnp.h"
#include "fsw/pose/region.h"
#include "tests/support/figures.h"
#include "tests/support/tango_view.h"

namespace vbar::fsw::pose {
namespace {

constexpr int kSide = network::kMapSide;

/// Logarithm of a Gaussian of that place and width, cells.
std::array<float, network::kMapCells> map_around(const Vector2& place, double sigma) {
  std::array<float, network::kMapCells> map{};
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double square = (Vector2(x, y) - place).squaredNorm() / (sigma * sigma);
      map[static_cast<std::size_t>(y * kSide + x)] = static_cast<float>(5.0 - 0.5 * square);
    }
  }
  return map;
}

struct Outcome {
  int poses = 0;
  accuracy::Largest worst_turn;
  accuracy::Largest worst_shift;  ///< of the range
  double normalised = 0.0;        ///< mean over poses
};

/// Maps as wide as training asks for, widened by the error that they are made with.
Outcome campaign(double error_cells, int problems) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  network::Calibration calibration;
  calibration.covariance_floor = 0.0025F;
  Outcome outcome;
  for (int n = 0; n < problems; ++n) {
    const TargetPose truth = test::random_pose(random, 5.0, 13.0);
    const CropRegion region = region_of(truth.position_camera_m, test::close_camera(), test::tango_shape()).value();
    Keypoints keypoints = test::seen_keypoints(truth, 0.0, 1.0, random);
    for (Keypoint& keypoint : keypoints) {
      const double dx = error_cells * normal(random);
      const double dy = error_cells * normal(random);
      const Vector2 place = region.place_of(keypoint.pixel, kSide) + Vector2(dx, dy);
      keypoint = keypoint_of(read_map(map_around(place, std::hypot(1.0, error_cells)), 1.0), calibration, region);
    }
    const auto found = solve_pnp(keypoints, test::tango_shape(), test::close_camera(), {}, 1);
    if (!found.ok()) continue;
    ++outcome.poses;
    const TargetPose& pose = found.value().pose;
    Vector6 error;
    error << test::turn_between(pose.R_camera_body, truth.R_camera_body),
        truth.position_camera_m - pose.position_camera_m;
    outcome.worst_turn.add(error.head<3>().norm());
    outcome.worst_shift.add(error.tail<3>().norm() / truth.position_camera_m.norm());
    const Eigen::Matrix<double, 6, 6> covariance = found.value().covariance;
    outcome.normalised += error.dot(Vector6(covariance.llt().solve(error))) / problems;
  }
  return outcome;
}

/// Logits in single precision place a keypoint to 1e-5 cells, 1e-4 px.
TEST(MapsToPose, ExactMapsGiveThePose) {
  const Outcome outcome = campaign(0.0, 200);
  EXPECT_EQ(outcome.poses, 200);
  EXPECT_LT(outcome.worst_turn, 1e-4);
  EXPECT_LT(outcome.worst_shift, 1e-4);
}

/// A network that is a quarter of a cell off on each axis, which is a sample of the crop.
TEST(MapsToPose, NoisyMapsGiveThePoseAndItsCovariance) {
  const Outcome outcome = campaign(0.25, 500);
  EXPECT_GE(outcome.poses, 498);
  EXPECT_LT(outcome.worst_turn, 10.0 / 57.3);
  // Mean of the chi-square of 6 degrees over 500: 6 +- 0.155; four sigmas
  EXPECT_NEAR(outcome.normalised, 6.0, 0.62);
}

}  // namespace
}  // namespace vbar::fsw::pose
