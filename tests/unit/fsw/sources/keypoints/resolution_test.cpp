// Which camera resolves the target from which range on: the figures of the two cameras of missions/full_range.toml.

#include "fsw/sources/keypoints/resolution.h"

#include <memory>

#include <gtest/gtest.h>

#include "fsw/sources/image_use.h"
#include "tests/unit/fsw/navigation/angles_only_scene.h"

namespace vbar::fsw::sources {
namespace {

using namespace navigation::test;

/// Of a target of 0.75 m radius: 13.5 samples of the network per metre at a scale of 1.
KeypointCameraSettings camera_of(double focal_length_px, int width, int height) {
  KeypointCameraSettings camera;
  camera.network.model.focal_length_px = {focal_length_px, focal_length_px};
  camera.network.frame = {.width = width, .height = height};
  camera.network.shape[3] = {0.0, 0.75, 0.0};
  return camera;
}
const KeypointCameraSettings kFar = camera_of(5972.7, 500, 800);    // 35 mm
const KeypointCameraSettings kClose = camera_of(1450.5, 800, 500);  // 17 mm, binned

class ResolutionTest : public testing::Test {
 protected:
  /// `lateral_m` across the line of sight and `along_m` along it, 1 sigma.
  void place(double range_m, double lateral_m = 0.01, double along_m = 0.1) {
    const Vector6 roe = roe_of_metres(0.0, -range_m, 0.0, 0.0, 0.0, 0.0);
    filter_ = std::make_unique<filter::RelativeNavigationFilter>();
    filter::FilterSettings blocks;
    blocks.earth = scene_earth();
    filter_->configure(blocks);
    filter_->advance_to(scene_start(), {});
    filter_->set_states(scene_servicer(), scene_target(scene_servicer(), roe));
    Matrix6 covariance = 1e-20 * Matrix6::Identity();
    const double a = scene_servicer().position_eci.norm();
    covariance(1, 1) = along_m * along_m / (a * a);
    covariance(4, 4) = covariance(5, 5) = lateral_m * lateral_m / (a * a);
    filter_->initialize_relative(roe, covariance, filter::SolutionStatus::kEstimated);
  }
  Resolution far(Resolution before) { return resolution_of(kFar, *filter_, before); }
  std::unique_ptr<filter::RelativeNavigationFilter> filter_ = std::make_unique<filter::RelativeNavigationFilter>();
};

// 2.3 * 0.75 m * 5972.7 px / 128 = 80.5 m.
TEST_F(ResolutionTest, ScaleIsPixelsPerSample) {
  EXPECT_NEAR(image_scale(kFar, 80.5), 1.0, 1e-3);
  EXPECT_NEAR(image_scale(kClose, 19.55), 1.0, 1e-3);
}

TEST_F(ResolutionTest, WithoutARangeAnImageMayShowAnything) {
  EXPECT_EQ(far(Resolution::kResolved), Resolution::kUnknown);
  place(60.0, 0.01, 15.0);
  EXPECT_EQ(far(Resolution::kResolved), Resolution::kUnknown) << "known to a quarter";
}

TEST_F(ResolutionTest, BeginsAndEndsAtDifferentRanges) {
  place(150.0);
  EXPECT_EQ(far(Resolution::kUnknown), Resolution::kTooSmall);
  EXPECT_EQ(far(Resolution::kResolved), Resolution::kResolved);
  place(130.0);
  EXPECT_EQ(far(Resolution::kTooSmall), Resolution::kResolved);
  place(185.0);
  EXPECT_EQ(far(Resolution::kResolved), Resolution::kTooSmall);
}

TEST_F(ResolutionTest, EndsWhereTheTargetFillsTheImage) {
  place(18.5);
  EXPECT_EQ(far(Resolution::kResolved), Resolution::kResolved);
  place(17.5);
  EXPECT_EQ(far(Resolution::kResolved), Resolution::kTooLarge) << "1.5 m are 512 px of 500";
  EXPECT_EQ(resolution_of(kClose, *filter_, Resolution::kTooSmall), Resolution::kResolved);
  place(18.5);
  EXPECT_EQ(far(Resolution::kTooLarge), Resolution::kResolved);
}

TEST_F(ResolutionTest, BearingsGoOnUntilThePlaceIsKnown) {
  place(100.0, 0.15);
  EXPECT_EQ(far(Resolution::kTooSmall), Resolution::kTooSmall);
}

TEST_F(ResolutionTest, TheSizeOfASmallImageIsLessCertain) {
  EXPECT_EQ(lasting_stretch_scale(3.0), 1.0);
  EXPECT_NEAR(lasting_stretch_scale(1.1), 4.0, 1e-12);
}

TEST(ExposureScheduler, EveryOtherImageIsForBearingsWhileKeypointsDoNotAid) {
  ExposureScheduler scheduler;
  EXPECT_FALSE(turns.is_bearing_due());
  for (int pair = 0; pair < 3; ++pair) {
    turns.take_keypoints(0.7, false);
    EXPECT_TRUE(turns.is_bearing_due());
    turns.take_bearing();
    EXPECT_FALSE(turns.is_bearing_due());
  }
  turns.take_keypoints(0.7, true);
  EXPECT_FALSE(turns.is_bearing_due());
  turns.take_keypoints(1.2, false);
  EXPECT_FALSE(turns.is_bearing_due()) << "too close for stars";
  turns.take_keypoints(std::nullopt, false);
  EXPECT_FALSE(turns.is_bearing_due()) << "at an unknown range";
}

TEST(TwoExposures, TheExposureStatesTheUse) {
  angles_only_configuration bearings{};
  pose_configuration keypoints{};
  EXPECT_FALSE(two_exposures(bearings, keypoints).ok());
  bearings.exposure_s = 0.2;
  keypoints.exposure_s = 0.1;
  EXPECT_FALSE(two_exposures(bearings, keypoints).ok()) << "too similar";
  keypoints.exposure_s = 1e-5;
  const auto both = two_exposures(bearings, keypoints);
  ASSERT_TRUE(both.ok());
  EXPECT_FALSE(both.value().is_for_keypoints(0.2));
  EXPECT_TRUE(both.value().is_for_keypoints(static_cast<double>(1e-5F)));
  EXPECT_TRUE(both.value().is_for_keypoints(1e-3)) << "nearer to the shorter, as ratios go";
  EXPECT_FALSE(both.value().is_for_keypoints(2e-3));
}

}  // namespace
}  // namespace vbar::fsw::sources
