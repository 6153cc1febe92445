// Limited progress from rest to rest: durations of cases that can be worked out, limits everywhere, stops at any
// moment.

#include "hil_drivers/tron/motion/s_curve.h"

#include <cmath>

#include <gtest/gtest.h>

namespace vbar::tron {
namespace {

constexpr ProgressLimits kLimits{2.0, 4.0, 40.0};

void expect_within_limits(const SCurve& curve, double end, double first_place) {
  constexpr int kSteps = 2000;
  double last = first_place;
  for (int k = 0; k <= kSteps; ++k) {
    const Progress at = curve.at(curve.duration_s() * k / kSteps);
    // Of rounding in sums of cubic polynomials.
    ASSERT_LE(at.speed, kLimits.speed + 1e-12);
    ASSERT_GE(at.speed, -1e-9);
    ASSERT_LE(std::abs(at.acceleration), kLimits.acceleration + 1e-12);
    ASSERT_GE(at.place, last - 1e-12);
    ASSERT_LE(at.place, end + 1e-12);
    last = at.place;
  }
}

TEST(TronSCurve, DurationsOfTheFourShapes) {
  // Cruising: distance / speed + speed / acceleration + acceleration / jerk.
  EXPECT_NEAR(rest_to_rest_s(10.0, kLimits), 10.0 / 2.0 + 2.0 / 4.0 + 4.0 / 40.0, 1e-12);
  // The acceleration is reached, the speed is not: T = sqrt((a/j)^2 + 4 d / a) + a / j.
  EXPECT_NEAR(rest_to_rest_s(0.5, kLimits), std::sqrt(0.01 + 4.0 * 0.5 / 4.0) + 0.1, 1e-12);
  // Neither: four ramps of cbrt(d / 2 j).
  EXPECT_NEAR(rest_to_rest_s(0.001, kLimits), 4.0 * std::cbrt(0.001 / 80.0), 1e-12);
  // The speed is reached before the acceleration is: two ramps of sqrt(v / j) on either side.
  const ProgressLimits slow{0.1, 4.0, 40.0};
  EXPECT_NEAR(rest_to_rest_s(1.0, slow), 1.0 / 0.1 + 2.0 * std::sqrt(0.1 / 40.0), 1e-12);
  EXPECT_EQ(rest_to_rest_s(0.0, kLimits), 0.0);
}

TEST(TronSCurve, GoesFromRestToRestWithinLimits) {
  for (const double distance : {1e-6, 0.001, 0.02, 0.1, 0.5, 1.0, 1.2, 10.0}) {
    const SCurve curve = SCurve::rest_to_rest(distance, kLimits);
    EXPECT_NEAR(curve.duration_s(), rest_to_rest_s(distance, kLimits), 1e-12);
    expect_within_limits(curve, distance, 0.0);
    EXPECT_EQ(curve.at(curve.duration_s()).place, distance);
    const Progress before_end = curve.at(curve.duration_s() * (1.0 - 1e-9));
    EXPECT_NEAR(before_end.place, distance, 1e-9 * distance);
    EXPECT_NEAR(before_end.speed, 0.0, 1e-6);
  }
}

TEST(TronSCurve, StopsFromAnyMomentNotBeyondTheEnd) {
  for (const double distance : {0.001, 0.1, 0.5, 10.0}) {
    const SCurve curve = SCurve::rest_to_rest(distance, kLimits);
    for (int k = 0; k <= 500; ++k) {
      const double time_s = curve.duration_s() * k / 500.0;
      const Progress from = curve.at(time_s);
      const SCurve stop = curve.stop_at(time_s);
      expect_within_limits(stop, distance, from.place);
      EXPECT_NEAR(stop.at(0.0).place, from.place, 1e-12);
      EXPECT_NEAR(stop.at(0.0).speed, from.speed, 1e-12);
      // Not longer than the motion itself, and than the slowest stop: speed / acceleration + 2 ramps.
      EXPECT_LE(stop.duration_s(), curve.duration_s() - time_s + 1e-6);
      EXPECT_LE(stop.duration_s(), 2.0 / 4.0 + 2.0 * 0.1 + 1e-9);
      const Progress almost = stop.at(stop.duration_s() * (1.0 - 1e-9));
      EXPECT_NEAR(almost.speed, 0.0, 1e-6);
      EXPECT_NEAR(almost.place, stop.at(stop.duration_s()).place, 1e-6);
    }
  }
}

}  // namespace
}  // namespace vbar::tron
