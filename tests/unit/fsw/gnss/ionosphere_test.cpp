// Klobuchar's model against the worked example and the document's own limiting cases.

#include "fsw/gnss/ionosphere.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/accuracy.h"

namespace vbar::fsw::gnss {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr KlobucharCoefficients kExample{.alpha = {3.82e-8, 1.49e-8, -1.79e-7, 0.0},
                                         .beta = {1.43e5, 0.0, -3.28e5, 1.13e5}};
constexpr LineOfSight kSight{
    .latitude = 40.0 * kDegree, .longitude = 260.0 * kDegree, .azimuth = 210.0 * kDegree, .elevation = 20.0 * kDegree};

GpsTime time_of_week(std::int64_t s) {
  return {(1000 * 604'800 + s) * kNanosecondsPerSecond};
}

TEST(Klobuchar, GivesTheWorkedExample) {
  // Classic example of the literature (Strang and Borre, Linear Algebra, Geodesy, and GPS): 23.784 m.
  const Result<double> delay = klobuchar_delay_l1_m(kExample, kSight, time_of_week(593'100));
  ASSERT_TRUE(delay.ok());
  accuracy::expect_below("Klobuchar delay", "worked example, 23.784 m", std::abs(delay.value() - 23.784), 5e-4, "m");
}

TEST(Klobuchar, AtNightItIsFiveNanosecondsTimesTheSlant) {
  // IS-GPS-200N: 5e-9 s and, towards the zenith, a factor of 1 + 16 (0.53 - 0.5)^3.
  LineOfSight zenith = kSight;
  zenith.elevation = M_PI / 2.0;
  const Result<double> delay = klobuchar_delay_l1_m(kExample, zenith, time_of_week(8 * 3600));  // 01:20 local time
  EXPECT_NEAR(delay.value(), 299'792'458.0 * 5e-9 * (1.0 + 16.0 * 0.03 * 0.03 * 0.03), 1e-12);
}

TEST(Klobuchar, RepeatsEveryDayAndEveryTurn) {
  const double delay = klobuchar_delay_l1_m(kExample, kSight, time_of_week(593'100)).value();
  // Local time to rounding: 1e-9 s of some 1e5, of a slope of metres an hour.
  EXPECT_NEAR(klobuchar_delay_l1_m(kExample, kSight, time_of_week(593'100 - 86'400)).value(), delay, 1e-9);
  LineOfSight turned = kSight;
  turned.longitude -= 2.0 * M_PI;
  EXPECT_NEAR(klobuchar_delay_l1_m(kExample, turned, time_of_week(593'100)).value(), delay, 1e-9);
}

TEST(Klobuchar, RefusesWhatItHasNoMeaningFor) {
  const auto with_elevation = [](double elevation) {
    LineOfSight sight = kSight;
    sight.elevation = elevation;
    return klobuchar_delay_l1_m(kExample, sight, time_of_week(0)).status();
  };
  EXPECT_EQ(with_elevation(0.0), Status::kOk);
  EXPECT_EQ(with_elevation(-1e-9), Status::kOutOfRange);
  EXPECT_EQ(with_elevation(-19.8 * kDegree), Status::kOutOfRange);
  EXPECT_EQ(with_elevation(1.58), Status::kOutOfRange);
  EXPECT_EQ(with_elevation(kNaN), Status::kOutOfRange);
  LineOfSight nowhere = kSight;
  nowhere.longitude = kNaN;
  EXPECT_EQ(klobuchar_delay_l1_m(kExample, nowhere, time_of_week(0)).status(), Status::kNotFinite);
  for (std::size_t k = 0; k < 4; ++k) {
    KlobucharCoefficients bad = kExample;
    bad.alpha[k] = kNaN;
    EXPECT_EQ(check(bad), Status::kNotFinite);
    bad = kExample;
    bad.beta[k] = 1e9;
    EXPECT_EQ(klobuchar_delay_l1_m(bad, kSight, time_of_week(0)).status(), Status::kOutOfRange);
  }
}

}  // namespace
}  // namespace vbar::fsw::gnss
