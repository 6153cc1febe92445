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

// The shell halves the electrons above the spacecraft: by quadrature of the Chapman profile exp(1 - z - e^-z), z the
// height over the peak at 420 km in units of 100 km. The slant factor at the horizon is that of the sine rule.
TEST(ShellCrossing, HalvesTheElectronsAboveTheSpacecraft) {
  constexpr double kEarth_m = 6371e3;
  for (const double altitude_m : {500e3, 709e3, 900e3}) {
    const Vector3 position = (kEarth_m + altitude_m) * Vector3(0.6, 0.0, 0.8), zenith(0.6, 0.0, 0.8),
                  level(0.8, 0.0, -0.6);
    const double shell_m = altitude_m + shell_crossing(position, zenith).distance_m;
    const auto electrons = [](double from_m, double to_m) {
      constexpr int kSteps = 20000;
      double sum = 0.0;
      for (int k = 0; k < kSteps; ++k) {
        const double z = (from_m + (k + 0.5) * (to_m - from_m) / kSteps - 420e3) / 100e3;
        sum += std::exp(1.0 - z - std::exp(-z));
      }
      return sum * (to_m - from_m) / kSteps;
    };
    // 2000 km above the spacecraft the rest is e^-20 of them; the midpoint rule is exact to 1e-6.
    EXPECT_NEAR(electrons(altitude_m, shell_m) / electrons(altitude_m, altitude_m + 2000e3), 0.5, 1e-5) << altitude_m;
    EXPECT_NEAR(shell_crossing(position, zenith).slant_factor, 1.0, 1e-12);
    const double sine = (kEarth_m + altitude_m) / (kEarth_m + shell_m);
    EXPECT_NEAR(shell_crossing(position, level).slant_factor, 1.0 / std::sqrt(1.0 - sine * sine), 1e-6);
    EXPECT_NEAR(shell_crossing(position, level).distance_m, (kEarth_m + shell_m) * std::sqrt(1.0 - sine * sine), 1e-3);
  }
}

TEST(ShellCrossing, IsVerticalAtTheGround) {
  const ShellCrossing crossing = shell_crossing(Vector3(6371e3, 0.0, 0.0), Vector3::UnitY());
  EXPECT_EQ(crossing.slant_factor, 1.0);
  EXPECT_EQ(crossing.distance_m, 0.0);
}

}  // namespace
}  // namespace vbar::fsw::gnss
