// The flight mathematics library against correctly rounded values, and its angle wrapping.

#include "fsw/math/math.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include "fsw/math/quadrature.h"
#include "tests/unit/fsw/math/reference_values.h"

namespace vbar::fsw::math {

namespace {

using reference::Binary;
using reference::Unary;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Steps on the double grid between two values of the same sign.
std::int64_t ulps(double a, double b) {
  const std::int64_t d = std::bit_cast<std::int64_t>(a) - std::bit_cast<std::int64_t>(b);
  return d < 0 ? -d : d;
}

// fdlibm and the ARM optimized routines promise an error under 1 ulp, so a result is the correctly rounded value or its
// neighbour.
template <class F, std::size_t N>
void expect_within_one_ulp(const char* name, F f, const Unary (&table)[N]) {
  for (const Unary& row : table) {
    EXPECT_LE(ulps(f(row.x), row.value), 1) << name << "(" << row.x << ") = " << f(row.x) << ", not " << row.value;
  }
}

template <class F, std::size_t N>
void expect_within_one_ulp(const char* name, F f, const Binary (&table)[N]) {
  for (const Binary& row : table) {
    EXPECT_LE(ulps(f(row.x, row.y), row.value), 1)
        << name << "(" << row.x << ", " << row.y << ") = " << f(row.x, row.y) << ", not " << row.value;
  }
}

TEST(FlightMath, IsWithinOneUlpOfTheCorrectlyRoundedValue) {
  expect_within_one_ulp("sin", sin, reference::kSin);
  expect_within_one_ulp("cos", cos, reference::kCos);
  expect_within_one_ulp("tan", tan, reference::kTan);
  expect_within_one_ulp("asin", asin, reference::kAsin);
  expect_within_one_ulp("acos", acos, reference::kAcos);
  expect_within_one_ulp("atan", atan, reference::kAtan);
  expect_within_one_ulp("exp", exp, reference::kExp);
  expect_within_one_ulp("log", log, reference::kLog);
  expect_within_one_ulp("erf", erf, reference::kErf);
  expect_within_one_ulp("erfc", erfc, reference::kErfc);
  expect_within_one_ulp("atan2", atan2, reference::kAtan2);
  expect_within_one_ulp("pow", pow, reference::kPow);
}

TEST(FlightMath, RemainderAndFloorAreExact) {
  for (const Binary& row : reference::kFmod) EXPECT_EQ(fmod(row.x, row.y), row.value) << row.x << " mod " << row.y;
  EXPECT_EQ(floor(2.7), 2.0);
  EXPECT_EQ(floor(-2.1), -3.0);
  EXPECT_EQ(floor(-0.5), -1.0);
  EXPECT_EQ(floor(2251799813685249.5), 2251799813685249.0);
  EXPECT_EQ(floor(1e300), 1e300);
}

TEST(FlightMath, FollowsIeee754AtTheEdges) {
  EXPECT_TRUE(std::signbit(sin(-0.0)));
  EXPECT_EQ(cos(0.0), 1.0);
  EXPECT_EQ(exp(-kInfinity), 0.0);
  EXPECT_EQ(exp(1000.0), kInfinity);
  EXPECT_EQ(exp(-1000.0), 0.0);
  EXPECT_EQ(log(0.0), -kInfinity);
  EXPECT_EQ(erf(kInfinity), 1.0);
  EXPECT_EQ(pow(kNan, 0.0), 1.0);
  EXPECT_EQ(atan2(0.0, -1.0), kPi);
  EXPECT_EQ(atan2(-0.0, -1.0), -kPi);
  EXPECT_EQ(atan2(0.0, 0.0), 0.0);
  for (double (*f)(double) : {sin, cos, tan, atan, exp, log, erf, asin, acos}) EXPECT_TRUE(std::isnan(f(kNan)));
  EXPECT_TRUE(std::isnan(sin(kInfinity)));
  EXPECT_TRUE(std::isnan(asin(1.5)));
  EXPECT_TRUE(std::isnan(log(-1.0)));
  EXPECT_TRUE(std::isnan(fmod(1.0, 0.0)));
}

TEST(FlightMath, KnowsWhatIsFinite) {
  EXPECT_TRUE(is_finite(0.0));
  EXPECT_TRUE(is_finite(-std::numeric_limits<double>::max()));
  EXPECT_TRUE(is_finite(std::numeric_limits<double>::denorm_min()));
  EXPECT_FALSE(is_finite(kInfinity));
  EXPECT_FALSE(is_finite(-kInfinity));
  EXPECT_FALSE(is_finite(kNan));
}

TEST(WrapToPi, LeavesTheHalfOpenIntervalAlone) {
  EXPECT_EQ(wrap_to_pi(0.0), 0.0);
  EXPECT_EQ(wrap_to_pi(kPi), kPi);
  const double above_minus_pi = std::nextafter(-kPi, 0.0);
  EXPECT_EQ(wrap_to_pi(above_minus_pi), above_minus_pi);
  EXPECT_EQ(wrap_to_pi(-1e-300), -1e-300);
}

TEST(WrapToPi, MapsTheOpenEndToTheClosedOne) {
  EXPECT_EQ(wrap_to_pi(-kPi), kPi);
  EXPECT_EQ(wrap_to_pi(std::nextafter(kPi, 4.0)), std::nextafter(kPi, 4.0) - kTwoPi);
  EXPECT_EQ(wrap_to_pi(kTwoPi), 0.0);
  EXPECT_EQ(wrap_to_pi(-kTwoPi), 0.0);
  EXPECT_EQ(wrap_to_pi(1.5 * kTwoPi), kPi);  // 3 pi in doubles is exactly 1.5 * (2 pi)
  EXPECT_EQ(wrap_to_pi(-1.5 * kTwoPi), kPi);
}

TEST(WrapToPi, IsExactAndStaysInsideForAnyFiniteAngle) {
  std::uint64_t state = 1;
  for (int k = 0; k < 100000; ++k) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;  // Knuth's MMIX generator
    const double angle = (static_cast<double>(state >> 11) * 0x1p-53 - 0.5) * 1e6;
    const double wrapped = wrap_to_pi(angle);
    ASSERT_GT(wrapped, -kPi);
    ASSERT_LE(wrapped, kPi);
    // The IEEE remainder is exact, so both agree to the bit wherever the remainder is not a tie at pi.
    ASSERT_EQ(wrapped, std::remainder(angle, kTwoPi)) << angle;
  }
  EXPECT_LE(abs(wrap_to_pi(1e300)), kPi);
  EXPECT_TRUE(std::isnan(wrap_to_pi(kInfinity)));
  EXPECT_TRUE(std::isnan(wrap_to_pi(kNan)));
}

}  // namespace

// Gauss-Legendre quadrature: what the rule is exact for.

namespace {

TEST(GaussLegendre, IsExactForPolynomialsOfDegree63) {
  for (int degree = 0; degree <= 63; ++degree) {
    const double integral = integrate([degree](double x) { return std::pow(x, degree); }, -1.0, 1.0);
    const double expected = degree % 2 == 0 ? 2.0 / (degree + 1) : 0.0;
    EXPECT_NEAR(integral, expected, 1e-15) << "degree " << degree;  // rounding of 32 terms that sum to at most 2
  }
}

TEST(GaussLegendre, ScalesToAnyInterval) {
  EXPECT_NEAR(integrate([](double x) { return std::exp(x); }, -2.0, 5.0), std::exp(5.0) - std::exp(-2.0), 1e-13);
  EXPECT_NEAR(integrate([](double x) { return 1.0 / (1.0 + x * x); }, 0.0, 1.0), std::atan(1.0), 1e-15);
  EXPECT_EQ(integrate([](double) { return 1.0; }, 3.0, 3.0), 0.0);
  EXPECT_NEAR(integrate([](double x) { return x; }, 2.0, 0.0), -2.0, 1e-15);  // reversed
}

}  // namespace

}  // namespace vbar::fsw::math
