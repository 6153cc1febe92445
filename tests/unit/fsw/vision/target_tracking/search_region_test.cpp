#include "fsw/vision/target_tracking/search_region.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace vbar::fsw::target_tracking {
namespace {

constexpr double kMeanMotion = 1.06e-3;  // 1/s, 700 km

Prediction at_metres(double sigma_m, double distance_m) {
  Prediction prediction;
  prediction.along_track_m = -distance_m;
  prediction.covariance.diagonal().setConstant(sigma_m * sigma_m / (distance_m * distance_m));
  return prediction;
}

TEST(SearchRegion, IsThePredictionUntilTheTargetIsMissed) {
  SearchRegion region;
  const Prediction prediction = at_metres(0.6, 3700.0);
  for (int k = 0; k < 200; ++k) region.note(true, false, false);
  EXPECT_FALSE(region.is_widened());  // the target was never seen
  region.note(true, true, true);
  for (int k = 0; k < 200; ++k) region.note(false, false, false);  // in eclipse
  for (int k = 0; k < SearchRegion::kPatience; ++k) region.note(true, false, false);
  EXPECT_FALSE(region.is_widened());
  EXPECT_EQ(region.widened(prediction, kMeanMotion).covariance, prediction.covariance);
}

// Half the diagonal of the Optical Stimulator's field is 4.5 deg. The gate about a prediction is 4.3 sigma (99.99 %).
TEST(SearchRegion, IsTheFieldOfViewWithinFortyImages) {
  SearchRegion region;
  region.note(true, true, true);
  double before = 0.0;
  for (int k = 0; k < 40; ++k) {
    region.note(true, false, false);
    EXPECT_GE(region.sigma(), before);
    before = region.sigma();
  }
  EXPECT_GT(4.3 * region.sigma(), 4.5 * 3.14159 / 180.0);
  const Prediction prediction = at_metres(0.6, 3700.0);
  const Prediction wide = region.widened(prediction, kMeanMotion);
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(wide.covariance(k, k), before * before, 1e-6);
  // An offset that oscillates once an orbit.
  for (int k = 2; k < 5; ++k) {
    EXPECT_NEAR(wide.covariance(k, k) - prediction.covariance(k, k), before * before * kMeanMotion * kMeanMotion,
                1e-12);
  }
  EXPECT_EQ(wide.slopes, prediction.slopes);
}

// The field, 7.7 deg along R and 4.8 along N, at the offsets of one cycle, covers 4.1 deg about the prediction in any
// direction.
TEST(SearchRegion, ThenTheCameraScansAboutThePrediction) {
  SearchRegion region;
  region.note(true, true, true);
  for (int k = 0; k < SearchRegion::kScanFrom; ++k) {
    EXPECT_EQ(region.scan_offset(), Vector2(Vector2::Zero()));
    region.note(true, false, false);
  }
  std::vector<Vector2> offsets;
  for (int k = 0; k < 16 * SearchRegion::kScanImages; ++k) {
    offsets.push_back(region.scan_offset());
    region.note(true, false, false);
  }
  // Half of the time where the target is predicted, never away from it for longer than one direction takes.
  int away = 0;
  for (const Vector2& offset : offsets) {
    away = offset.isZero() ? 0 : away + 1;
    EXPECT_LE(away, SearchRegion::kScanImages);
  }
  EXPECT_EQ(std::ranges::count(offsets, Vector2(Vector2::Zero())), 8 * SearchRegion::kScanImages);
  constexpr double kDegree = 3.14159265 / 180.0;
  for (double angle = 0.0; angle < 6.28; angle += 0.1) {
    const Vector2 target = 4.1 * kDegree * Vector2(std::cos(angle), std::sin(angle));
    bool is_seen = false;
    for (const Vector2& offset : offsets) {
      const Vector2 from_middle = (target - offset).cwiseAbs();
      is_seen = is_seen || (from_middle.x() < 3.85 * kDegree && from_middle.y() < 2.4 * kDegree);
    }
    EXPECT_TRUE(is_seen) << angle;
  }
}

TEST(SearchRegion, StaysWhileAnObjectIsTrackedAndEndsWithAUsedBearing) {
  SearchRegion region;
  region.note(true, true, true);
  for (int k = 0; k < 20; ++k) region.note(true, false, false);
  const double searched = region.sigma();
  ASSERT_TRUE(region.is_widened());
  for (int k = 0; k < 20; ++k) region.note(true, true, false);
  EXPECT_EQ(region.sigma(), searched);
  region.note(true, true, true);
  EXPECT_FALSE(region.is_widened());
  EXPECT_EQ(region.sigma(), 0.0);
}

}  // namespace
}  // namespace vbar::fsw::target_tracking
