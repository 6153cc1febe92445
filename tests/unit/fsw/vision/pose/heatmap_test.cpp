// Keypoints out of synthetic maps: Gaussians of known place and width.

#include "fsw/vision/pose/heatmap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "fsw/vision/pose/crop.h"
#include "fsw/vision/pose/pnp.h"
#include "tests/support/figures.h"
#include "tests/support/tango_view.h"

namespace vbar::fsw::pose {

namespace {

constexpr int kSide = pose::kMapSide;
using Map = std::array<float, pose::kMapCells>;

/// Logarithm of a sum of Gaussians and a pedestal.
template <class Density>
Map map_of(Density density) {
  Map map{};
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      map[static_cast<std::size_t>(y * kSide + x)] = static_cast<float>(std::log(std::max(1e-300, density(x, y))));
    }
  }
  return map;
}

double gaussian(double x, double y, double cx, double cy, double sigma) {
  return std::exp(-0.5 * ((x - cx) * (x - cx) + (y - cy) * (y - cy)) / (sigma * sigma));
}

/// Place and width to the tails that the window cuts of a Gaussian wider than the training's; the training's own
/// exactly, up to the row beside the border.
TEST(Heatmap, AGaussiansPlaceAndWidth) {
  for (const Vector2& place : {Vector2(10.0, 12.0), Vector2(10.3, 20.7), Vector2(15.5, 4.5), Vector2(29.9, 1.2)}) {
    const auto read = [&](double sigma) {
      return read_map(map_of([&](int x, int y) { return gaussian(x, y, place.x(), place.y(), sigma); }), 1.0);
    };
    const MapPeak same = read(1.0);
    EXPECT_FALSE(same.is_at_border);
    // Logarithms in single precision: 1e-7
    EXPECT_LT((same.place - place).norm(), 1e-5);
    EXPECT_LT(accuracy::largest_entry(same.excess), 1e-5);
  }
  const MapPeak wider = read_map(map_of([](int x, int y) { return gaussian(x, y, 10.3, 20.7, 1.1); }), 1.0);
  EXPECT_NEAR(wider.place.x(), 10.3, 0.01);
  EXPECT_NEAR(wider.place.y(), 20.7, 0.01);
  // 1.21 - 1; beyond 3 cells lies 0.016 of the second moment more than of the training's
  EXPECT_NEAR(wider.excess(0, 0), 0.21, 0.02);
  EXPECT_NEAR(wider.excess(1, 1), 0.21, 0.02);
  EXPECT_NEAR(wider.excess(0, 1), 0.0, 1e-5);
}

/// Of a Gaussian of sigma 1 on a cell's centre the 3 x 3 cells hold (1 + 2 e^-1/2)^2 / 2 pi.
TEST(Heatmap, PeakIsTheShareOfNineCells) {
  const MapPeak peak = read_map(map_of([](int x, int y) { return gaussian(x, y, 16.0, 16.0, 1.0); }), 1.0);
  const double row = 1.0 + 2.0 * std::exp(-0.5);
  EXPECT_NEAR(peak.peak, row * row / (2.0 * 3.14159265358979), 1e-6);
  // Four cells off in a row: e^-8
  EXPECT_NEAR(peak.second, std::exp(-8.0), 1e-8);
}

/// A pedestal of a hundredth of the peak moves the mean of the whole map by cells; that of the window stays.
TEST(Heatmap, APedestalDoesNotDrawTheMean) {
  const MapPeak peak = read_map(map_of([](int x, int y) { return gaussian(x, y, 8.3, 20.7, 1.0) + 0.01; }), 1.0);
  EXPECT_NEAR(peak.place.x(), 8.3, 0.03);
  EXPECT_NEAR(peak.place.y(), 20.7, 0.03);
  // 48 of the window's cells at 0.01 with a mean square of 4: 1.9 on 6.28 + 0.5
  EXPECT_NEAR(peak.excess(0, 0), (6.28 + 0.49 * 4.0) / (6.28 + 0.49) - 1.0, 0.06);
}

TEST(Heatmap, TwoPeaksAreNone) {
  for (const double other : {0.5, 0.7, 0.99}) {
    const MapPeak peak =
        read_map(map_of([&](int x, int y) {
                   return gaussian(x, y, 8.0, 20.0, 1.0) + other * gaussian(x, y, 22.0, 20.0, 1.0) + 1e-9;
                 }),
                 1.0);
    EXPECT_NEAR(peak.place.x(), 8.0, 0.01) << "never between the two";
    EXPECT_NEAR(peak.second, other, 1e-6);
    EXPECT_EQ(keypoint_of(peak, {}, {{0.0, 0.0}, 320.0}).is_usable, other < 0.6);
  }
}

TEST(Heatmap, CovarianceIsTheExcessOverTrainingsGaussian) {
  pose::Calibration calibration;
  calibration.covariance_scale = 2.0F;
  calibration.covariance_floor = 0.25F;
  MapPeak peak;
  peak.excess << 1.0, 0.0, 0.0, -0.5;  // the second is narrower than what training asked for
  const Matrix2 covariance = place_covariance(peak, calibration);
  EXPECT_DOUBLE_EQ(covariance(0, 0), 2.25);
  EXPECT_DOUBLE_EQ(covariance(1, 1), 0.25);
  // The same turned by 45 degrees: eigenvalues 1 and -0.5 along the diagonals
  peak.excess << 0.25, 0.75, 0.75, 0.25;
  const Matrix2 turned = place_covariance(peak, calibration);
  EXPECT_NEAR(turned(0, 0), 1.25, 1e-14);
  EXPECT_NEAR(turned(0, 1), 1.0, 1e-14);
}

TEST(Heatmap, OnTheDetectorInPixels) {
  const CropRegion region{{400.0, 300.0}, 320.0};  // 10 px a cell
  MapPeak peak;
  peak.place = {16.0, 15.0};
  peak.excess = Matrix2::Identity();
  peak.peak = 0.5;
  const Keypoint keypoint = keypoint_of(peak, {}, region);
  EXPECT_TRUE(keypoint.is_usable);
  // The middle of 32 cells is between 15 and 16
  EXPECT_DOUBLE_EQ(keypoint.pixel.x(), 405.0);
  EXPECT_DOUBLE_EQ(keypoint.pixel.y(), 295.0);
  EXPECT_NEAR(keypoint.covariance_px2(0, 0), 100.0, 1e-12);
}

TEST(Heatmap, StretchedAboutTheMiddleOfTheCrop) {
  pose::Calibration calibration;
  calibration.stretch = 0.0625F;
  MapPeak peak;
  peak.place = {31.5, 15.5};
  peak.peak = 0.5;
  const Keypoint keypoint = keypoint_of(peak, calibration, {{400.0, 300.0}, 320.0});
  EXPECT_DOUBLE_EQ(keypoint.pixel.x(), 400.0 + 160.0 * 1.0625);
  EXPECT_DOUBLE_EQ(keypoint.pixel.y(), 300.0);
}

TEST(Heatmap, WhatTellsNothing) {
  pose::Calibration calibration;
  calibration.least_peak = 0.2F;
  const CropRegion region{{400.0, 300.0}, 320.0};
  const auto is_usable = [&](const Map& map) { return keypoint_of(read_map(map, 1.0), calibration, region).is_usable; };
  EXPECT_TRUE(is_usable(map_of([](int x, int y) { return gaussian(x, y, 16.0, 1.0, 1.0); })));
  EXPECT_FALSE(is_usable(map_of([](int x, int y) { return gaussian(x, y, 16.0, 0.0, 1.0); }))) << "border";
  EXPECT_FALSE(is_usable(map_of([](int x, int y) { return gaussian(x, y, 33.0, 8.0, 1.0); }))) << "beyond the border";
  EXPECT_FALSE(is_usable(map_of([](int x, int y) { return gaussian(x, y, 16.0, 16.0, 3.0); }))) << "too wide";
  EXPECT_FALSE(is_usable(map_of([](int, int) { return 1.0; }))) << "flat";
  Map broken = map_of([](int x, int y) { return gaussian(x, y, 16.0, 16.0, 1.0); });
  broken[77] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(is_usable(broken));
  broken[77] = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(is_usable(broken));
}

}  // namespace

// From maps to the pose: Gaussian maps around where Tango's keypoints are, as a network that makes errors of a known
// size would give them.

namespace {

/// Logarithm of a Gaussian of that place and width, cells.
std::array<float, pose::kMapCells> map_around(const Vector2& place, double sigma) {
  std::array<float, pose::kMapCells> map{};
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
  pose::Calibration calibration;
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
