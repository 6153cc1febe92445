// The likelihood ratio of a displacement, against the closed form for equal independent variances, chi-square, and
// outliers; and the covariance of an unknown burn against the motion of Clohessy and Wiltshire.

#include "fsw/measurements/cdgnss/displacement_test.h"

#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "fsw/filter/relative_navigation_filter.h"
#include "fsw/filter/relative_orbit.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::measurements {
namespace {

constexpr int kRows = 10;
constexpr double kSigma_m = 2e-3;
constexpr double kGate = 40.0;
constexpr double kMaxRest = 4.0;

/// Directions over the sky, the same in each test.
Vector3 direction(int row) {
  const double azimuth = 2.4 * row;
  const double height = 0.1 + 0.85 * row / kRows;
  const double across = std::sqrt(1.0 - height * height);
  return {across * std::cos(azimuth), across * std::sin(azimuth), height};
}

/// Rows with independent noise of kSigma_m, displaced by `metres`.
DisplacementTest rows_of(const Vector3& metres, std::mt19937& random, double noise = 1.0) {
  std::normal_distribution<double> normal;
  DisplacementTest test;
  test.clear();
  for (int row = 0; row < kRows; ++row) {
    test.add(direction(row).dot(metres) + noise * kSigma_m * normal(random), direction(row));
    test.set_covariance(row, row, kSigma_m * kSigma_m);
  }
  return test;
}

/// With S = s^2 I and y = G b exactly, the ratio is b' G' G b / s^2 and the best displacement is b.
TEST(DisplacementTest, OfAnExactDisplacementIsItsNormalisedSquare) {
  std::mt19937 random(1);
  const Vector3 metres(0.03, -0.02, 0.05);
  double expected = 0.0;
  for (int row = 0; row < kRows; ++row) expected += std::pow(direction(row).dot(metres) / kSigma_m, 2);
  const Displacement found = rows_of(metres, random, 0.0).evaluate(kGate, kMaxRest);
  EXPECT_TRUE(found.is_detected);
  EXPECT_NEAR(found.ratio, expected, 1e-9 * expected);
  EXPECT_LT((found.metres - metres).norm(), 1e-12);
}

/// Chi-square with three degrees of freedom: mean 3, variance 6; over 4,000 draws the mean has a sigma of 0.039, of
/// which five are allowed. None of them reaches 40 (probability 1e-8).
TEST(DisplacementTest, OfNoiseIsChiSquareWithThreeDegrees) {
  std::mt19937 random(2);
  double sum = 0.0;
  constexpr int kDraws = 4000;
  for (int k = 0; k < kDraws; ++k) {
    const Displacement found = rows_of(Vector3::Zero(), random).evaluate(kGate, kMaxRest);
    EXPECT_TRUE(found.is_tested);
    EXPECT_FALSE(found.is_detected);
    sum += found.ratio;
  }
  EXPECT_NEAR(sum / kDraws, 3.0, 5.0 * std::sqrt(6.0 / kDraws));
}

/// A slip of one or two channels is no displacement, and hides none.
TEST(DisplacementTest, SlipsAreNoDisplacementAndHideNone) {
  std::mt19937 random(3);
  for (const Vector3& metres : {Vector3(Vector3::Zero()), Vector3(0.1, 0.2, -0.1)}) {
    DisplacementTest test;
    test.clear();
    for (int row = 0; row < kRows; ++row) {
      const double slip = row == 2 ? 0.19 : row == 7 ? -0.57 : 0.0;
      test.add(direction(row).dot(metres) + slip, direction(row));
      test.set_covariance(row, row, kSigma_m * kSigma_m);
    }
    const Displacement found = test.evaluate(kGate, kMaxRest);
    EXPECT_EQ(found.is_detected, metres.norm() > 0.0);
    if (found.is_detected) {
      EXPECT_LT((found.metres - metres).norm(), 1e-9);
    }
  }
}

/// An error that all rows have in common, with its covariance, is a clock and no displacement.
TEST(DisplacementTest, AClockIsNoDisplacement) {
  DisplacementTest test;
  test.clear();
  for (int row = 0; row < kRows; ++row) {
    test.add(50.0, direction(row));
    for (int other = 0; other < row; ++other) test.set_covariance(row, other, 1e4);
    test.set_covariance(row, row, 1e4 + kSigma_m * kSigma_m);
  }
  const Displacement found = test.evaluate(kGate, kMaxRest);
  EXPECT_TRUE(found.is_tested);
  EXPECT_LT(found.ratio, 1.0);
}

TEST(DisplacementTest, FiveRowsAreTooFew) {
  DisplacementTest test;
  test.clear();
  for (int row = 0; row < DisplacementTest::kMinRows - 1; ++row) {
    test.add(1.0, direction(row));
    test.set_covariance(row, row, kSigma_m * kSigma_m);
  }
  EXPECT_FALSE(test.evaluate(kGate, kMaxRest).is_tested);
}

/// Position after a change of velocity of the target `t` ago on a circular orbit (Clohessy and Wiltshire 1960).
Matrix3 displacement_per_velocity(double n, double t) {
  const double s = std::sin(n * t), c = std::cos(n * t);
  Matrix3 map;
  map << s / n, 2.0 * (1.0 - c) / n, 0.0, -2.0 * (1.0 - c) / n, (4.0 * s - 3.0 * n * t) / n, 0.0, 0.0, 0.0, s / n;
  return map;
}

/// The covariance of a burn at a uniformly distributed time is the mean of the map's squares. Three-point quadrature
/// on an orbit with an eccentricity of 1e-6, of which the map for near-circular orbits neglects terms of its size: a
/// percent.
TEST(UnknownBurn, InflatesAsTheMotionAfterIt) {
  const orbit::QnsElements elements{7087300.0, 1e-6, 0.0, 1.7, 3.6, 0.3};
  const double n = orbit::mean_motion(elements.a);
  for (const double since_s : {20.0, 300.0, 1800.0}) {
    const auto filter = std::make_unique<filter::RelativeNavigationFilter>();
    filter->set_states(orbit::cartesian_from_qns(elements).value(),
                       {.position_eci = orbit::cartesian_from_qns(elements).value().position_eci + Vector3(3, 5, 2),
                        .velocity_eci = orbit::cartesian_from_qns(elements).value().velocity_eci});
    const double sigma = 1e-3;
    const Matrix6 before = filter::covariance_rtn(filter->estimate(), filter->servicer());
    filter->inflate_by_burn(filter->epoch() - nearest_duration(since_s), sigma);
    const Matrix6 added = filter::covariance_rtn(filter->estimate(), filter->servicer()) - before;
    Matrix3 expected = Matrix3::Zero();
    constexpr int kSteps = 2000;
    for (int k = 0; k < kSteps; ++k) {
      const Matrix3 map = displacement_per_velocity(n, since_s * (k + 0.5) / kSteps);
      expected += sigma * sigma / kSteps * map * map.transpose();
    }
    const double tolerance = 0.01 * expected.trace();
    EXPECT_LT((added.topLeftCorner<3, 3>() - expected).norm(), tolerance) << since_s;
  }
}

}  // namespace
}  // namespace vbar::fsw::measurements
