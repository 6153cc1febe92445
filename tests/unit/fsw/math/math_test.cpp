// The flight mathematics library against correctly rounded values, and its angle wrapping.

#include "fsw/math/math.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include "fsw/math/quadrature.h"

namespace vbar::fsw::math::reference {
namespace {

// Values of the elementary functions, correctly rounded to double: computed with mpmath 1.3.0 at 400 bits and rounded
// to nearest. Arguments: around zero, the break points of fdlibm's approximations, and far from zero, where argument
// reduction has to carry many bits of pi. fmod is exact; its values are those of any conforming C library.

struct Unary {
  double x, value;
};
struct Binary {
  double x, y, value;
};

constexpr Unary kSin[] = {
    {0x1.b7cdfd9d7bdbbp-34, 0x1.b7cdfd9d7bdbbp-34}, {0x1.999999999999ap-4, 0x1.98eaecb8bcb2cp-4},
    {0x1.0000000000000p-1, 0x1.eaee8744b05f0p-2},   {0x1.921fb54442d18p-1, 0x1.6a09e667f3bccp-1},
    {0x1.921fb54442d18p+0, 0x1.0000000000000p+0},   {0x1.0000000000000p+1, 0x1.d18f6ead1b446p-1},
    {0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53},  {-0x1.0000000000000p+2, 0x1.837b9dddc1eaep-1},
    {0x1.921fb54442d18p+2, -0x1.1a62633145c07p-52}, {0x1.9000000000000p+6, -0x1.03425b78c4db8p-1},
    {0x1.24f8200000000p+17, 0x1.f62915576ea36p-1},  {0x1.c6bf526340000p+49, 0x1.b76f88136cebap-1},
    {-0x1.0f0cf064dd592p+73, 0x1.b453ab76bf397p-1}, {0x1.0000000000000p+1000, -0x1.460b8ae1c886ep-3},
};
constexpr Unary kCos[] = {
    {0x1.b7cdfd9d7bdbbp-34, 0x1.0000000000000p+0},  {0x1.999999999999ap-4, 0x1.fd712f9a817c1p-1},
    {0x1.0000000000000p-1, 0x1.c1528065b7d50p-1},   {0x1.921fb54442d18p-1, 0x1.6a09e667f3bcdp-1},
    {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54},  {0x1.0000000000000p+1, -0x1.aa22657537205p-2},
    {0x1.921fb54442d18p+1, -0x1.0000000000000p+0},  {-0x1.0000000000000p+2, -0x1.4eaa606db24c1p-1},
    {0x1.921fb54442d18p+2, 0x1.0000000000000p+0},   {0x1.9000000000000p+6, 0x1.b981dbf665fdfp-1},
    {0x1.24f8200000000p+17, -0x1.8f93a82702748p-3}, {0x1.c6bf526340000p+49, -0x1.06c154609d33fp-1},
    {-0x1.0f0cf064dd592p+73, 0x1.0be2cef01c8f4p-1}, {0x1.0000000000000p+1000, 0x1.f9785160c8815p-1},
};
constexpr Unary kTan[] = {
    {0x1.b7cdfd9d7bdbbp-34, 0x1.b7cdfd9d7bdbbp-34}, {0x1.999999999999ap-4, 0x1.9af8877430b80p-4},
    {0x1.0000000000000p-1, 0x1.17b4f5bf3474ap-1},   {0x1.921fb54442d18p-1, 0x1.fffffffffffffp-1},
    {0x1.921fb54442d18p+0, 0x1.d02967c31cdb5p+53},  {0x1.0000000000000p+1, -0x1.17af62e0950f8p+1},
    {-0x1.0000000000000p+2, -0x1.2866f9be4de13p+0}, {0x1.9000000000000p+6, -0x1.2ca74d62b5d38p-1},
    {0x1.24f8200000000p+17, -0x1.41b91d5606dddp+2}, {0x1.c6bf526340000p+49, -0x1.ac23600a95be4p+0},
};
constexpr Unary kAsin[] = {
    {0x1.b7cdfd9d7bdbbp-34, 0x1.b7cdfd9d7bdbbp-34}, {0x1.999999999999ap-4, 0x1.9a49276037884p-4},
    {0x1.ffe5c91d14e3cp-2, 0x1.0c06011bb06b4p-1},   {0x1.0000000000000p-1, 0x1.0c152382d7366p-1},
    {0x1.6a09e667f3bcdp-1, 0x1.921fb54442d19p-1},   {0x1.ccccccccccccdp-1, 0x1.1ea93705fa172p+0},
    {0x1.fffffff768fa1p-1, 0x1.921cc6f77cacbp+0},   {-0x1.3333333333333p-2, -0x1.380159e14f6ffp-2},
    {-0x1.0000000000000p+0, -0x1.921fb54442d18p+0},
};
constexpr Unary kAcos[] = {
    {0x1.b7cdfd9d7bdbbp-34, 0x1.921fb543d4de0p+0}, {0x1.999999999999ap-4, 0x1.787b22ce3f590p+0},
    {0x1.ffe5c91d14e3cp-2, 0x1.0c1cb4b66a9bep+0},  {0x1.0000000000000p-1, 0x1.0c152382d7366p+0},
    {0x1.6a09e667f3bcdp-1, 0x1.921fb54442d18p-1},  {0x1.ccccccccccccdp-1, 0x1.cdd9f8f922e98p-2},
    {0x1.fffffff768fa1p-1, 0x1.772663126c72dp-15}, {-0x1.3333333333333p-2, 0x1.e0200bbc96ad8p+0},
    {-0x1.0000000000000p+0, 0x1.921fb54442d18p+1},
};
constexpr Unary kAtan[] = {
    {0x1.b7cdfd9d7bdbbp-34, 0x1.b7cdfd9d7bdbbp-34}, {0x1.999999999999ap-4, 0x1.983e282e2cc4dp-4},
    {0x1.c000000000000p-2, 0x1.a64eec3cc23fdp-2},   {0x1.6000000000000p-1, 0x1.345f01cce37bbp-1},
    {0x1.0000000000000p+0, 0x1.921fb54442d18p-1},   {0x1.3000000000000p+0, 0x1.bde70ed439fe7p-1},
    {0x1.3800000000000p+1, 0x1.2e75728833a54p+0},   {0x1.4000000000000p+3, 0x1.789bd2c160054p+0},
    {0x1.2a05f20000000p+33, 0x1.921fb543d4de0p+0},  {-0x1.6666666666666p-1, -0x1.38b112d7bd4adp-1},
};
constexpr Unary kExp[] = {
    {-0x1.5e00000000000p+9, 0x1.14f2b0fb9307fp-1010}, {-0x1.9400000000000p+5, 0x1.1ad9f47f3722ap-73},
    {-0x1.0000000000000p+0, 0x1.78b56362cef38p-2},    {-0x1.b7cdfd9d7bdbbp-34, 0x1.ffffffff24190p-1},
    {0x1.4f8b588e368f1p-17, 0x1.0000a7c5e340ep+0},    {0x1.0000000000000p-1, 0x1.a61298e1e069cp+0},
    {0x1.0000000000000p+0, 0x1.5bf0a8b145769p+1},     {0x1.4000000000000p+3, 0x1.5829dcf950560p+14},
    {0x1.9100000000000p+6, 0x1.8c39b9134bac4p+144},   {0x1.5e00000000000p+9, 0x1.d945df4f8ec8ep+1009},
};
constexpr Unary kLog[] = {
    {0x1.56e1fc2f8f359p-997, -0x1.5963447f87fb5p+9}, {0x1.4f8b588e368f1p-17, -0x1.7069e2aa2aa5bp+3},
    {0x1.0000000000000p-1, -0x1.62e42fefa39efp-1},   {0x1.ccccccccccccdp-1, -0x1.af8e8210a415cp-4},
    {0x1.ffffde7210be9p-1, -0x1.0c6f82d74d230p-20},  {0x1.000001ad7f29bp+0, 0x1.ad7f2847b6492p-24},
    {0x1.199999999999ap+0, 0x1.8663f793c46ccp-4},    {0x1.0000000000000p+1, 0x1.62e42fefa39efp-1},
    {0x1.4000000000000p+3, 0x1.26bb1bbb55516p+1},    {0x1.b003ebc6a7efap+22, 0x1.f8b87f27e0f1ep+3},
    {0x1.7e43c8800759cp+996, 0x1.5963447f87fb5p+9},
};
constexpr Unary kErf[] = {
    {0x1.b7cdfd9d7bdbbp-34, 0x1.f044332d68161p-34}, {0x1.999999999999ap-4, 0x1.cca5ea24fb334p-4},
    {0x1.0000000000000p-1, 0x1.0a7ef5c18edd2p-1},   {0x1.b000000000000p-1, 0x1.88d1cd474a2e0p-1},
    {0x1.0000000000000p+0, 0x1.af767a741088bp-1},   {0x1.4000000000000p+0, 0x1.d8865d98abe01p-1},
    {0x1.0000000000000p+1, 0x1.fd9ae142795e3p-1},   {0x1.6db22d0e56042p+1, 0x1.fff9019809317p-1},
    {0x1.0000000000000p+2, 0x1.ffffff7b91176p-1},   {-0x1.6666666666666p-1, -0x1.5b08c21171646p-1},
};
constexpr Unary kErfc[] = {
    {0x1.b7cdfd9d7bdbbp-34, 0x1.ffffffff07ddep-1}, {0x1.999999999999ap-4, 0x1.c66b42bb60999p-1},
    {0x1.0000000000000p-1, 0x1.eb02147ce245cp-2},  {0x1.b000000000000p-1, 0x1.dcb8cae2d747fp-3},
    {0x1.0000000000000p+0, 0x1.4226162fbddd5p-3},  {0x1.4000000000000p+0, 0x1.3bcd133aa0ffcp-4},
    {0x1.0000000000000p+1, 0x1.328f5ec350e67p-8},  {0x1.6db22d0e56042p+1, 0x1.bf99fdb3a2132p-15},
    {0x1.0000000000000p+2, 0x1.08ddd13bd35e7p-26}, {0x1.4000000000000p+3, 0x1.7d8a7f2a8a2d0p-149},
    {-0x1.6666666666666p-1, 0x1.ad846108b8b23p+0},
};
constexpr Binary kAtan2[] = {
    {0x1.b7cdfd9d7bdbbp-34, 0x1.0000000000000p+0, 0x1.b7cdfd9d7bdbbp-34},
    {0x1.0000000000000p+0, 0x1.0000000000000p+0, 0x1.921fb54442d18p-1},
    {0x1.0000000000000p+0, -0x1.0000000000000p+0, 0x1.2d97c7f3321d2p+1},
    {-0x1.0000000000000p+0, -0x1.0000000000000p+0, -0x1.2d97c7f3321d2p+1},
    {-0x1.0000000000000p+0, 0x1.0000000000000p+0, -0x1.921fb54442d18p-1},
    {0x1.8000000000000p+1, -0x1.5798ee2308c3ap-27, 0x1.921fb55293db7p+0},
    {0x1.3333333333333p-2, 0x1.6666666666666p-1, 0x1.9e9bf3d20dc71p-2},
    {-0x1.ab3f000000000p+22, 0x1.7c0e666666666p+13, -0x1.91add88f96d37p+0},
    {0x1.56e1fc2f8f359p-997, -0x1.0000000000000p+0, 0x1.921fb54442d18p+1},
    {0x1.4000000000000p+2, 0x0.0p+0, 0x1.921fb54442d18p+0},
};
constexpr Binary kPow[] = {
    {0x1.0000000000000p+1, 0x1.0000000000000p-1, 0x1.6a09e667f3bcdp+0},
    {0x1.4000000000000p+3, -0x1.8000000000000p+1, 0x1.0624dd2f1a9fcp-10},
    {0x1.b003ebc6a7efap+22, 0x1.8000000000000p+0, 0x1.189b6e67d1e55p+34},
    {0x1.000001ad7f29bp+0, 0x1.312d000000000p+23, 0x1.5bf0a790ce6f2p+1},
    {0x1.3333333333333p-2, 0x1.6666666666666p-1, 0x1.b8d809c615f41p-2},
    {-0x1.0000000000000p+1, 0x1.8000000000000p+1, -0x1.0000000000000p+3},
    {0x1.b7cdfd9d7bdbbp-34, 0x1.4000000000000p+4, 0x1.87e92154ef7b1p-665},
    {0x1.199999999999ap+0, 0x1.b580000000000p+12, 0x1.70482352af339p+962},
    {0x1.8000000000000p+1, -0x1.2c40000000000p+9, 0x1.2c3fe31a13ba2p-952},
};
constexpr Binary kFmod[] = {
    {0x1.4000000000000p+3, 0x1.8000000000000p+1, 0x1.0000000000000p+0},
    {-0x1.4000000000000p+3, 0x1.8000000000000p+1, -0x1.0000000000000p+0},
    {0x1.c6bf526340000p+49, 0x1.921fb54442d18p+2, 0x1.1307f0db4c7b0p+1},
    {0x1.5333333333333p+2, -0x1.999999999999ap-4, 0x1.9999999999978p-4},
    {0x1.7e43c8800759cp+996, 0x1.c000000000000p+2, 0x1.0000000000000p+0},
    {0x1.999999999999ap-4, 0x1.3333333333333p-2, 0x1.999999999999ap-4},
};

}  // namespace
}  // namespace vbar::fsw::math::reference

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
