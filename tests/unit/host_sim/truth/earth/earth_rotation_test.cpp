#include "host_sim/truth/earth/earth_rotation.h"

#include <cmath>
#include <memory>
#include <random>
#include <stdexcept>

#include <Eigen/LU>
#include <erfa.h>
#include <erfam.h>
#include <gtest/gtest.h>

#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/earth/iau2006_epochs.h"
#include "tests/unit/host_sim/truth/truth_fixture.h"

namespace vbar::truth {
namespace {

fsw::Matrix3 matrix(const double (&rows)[3][3]) {
  fsw::Matrix3 m;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m(i, j) = rows[i][j];
  }
  return m;
}

double largest_difference(const CelestialPole& a, const CelestialPole& b) {
  return accuracy::largest_entry(fsw::Vector3(a.x - b.x, a.y - b.y, a.s - b.s));
}

TEST(EarthRotation, TwelveEpochsOfTheIau2006Chain) {
  CelestialPoleInterpolator interpolator;
  accuracy::Largest pole, pole_interpolated, rotation, rotation_interpolated;
  for (const test::Iau2006Epoch& epoch : test::kIau2006Epochs) {
    const JulianDate tt{2451545.0, epoch.tt_centuries * 36525.0};
    const CelestialPole reference{epoch.x, epoch.y, epoch.s};
    pole.add(largest_difference(celestial_pole_iau2006a(tt), reference));
    const CelestialPole interpolated = interpolator.at(tt);
    pole_interpolated.add(largest_difference(interpolated, reference));
    // The reference matrix from its own era and s'.
    const fsw::Matrix3 composed = R_itrf_gcrf(reference, epoch.era, 0.0, 0.0, epoch.sp);
    rotation.add(accuracy::largest_entry(composed - matrix(epoch.R_itrs_gcrs)));
    const fsw::Matrix3 with_interpolation = R_itrf_gcrf(interpolated, epoch.era, 0.0, 0.0, epoch.sp);
    rotation_interpolated.add(accuracy::largest_entry(with_interpolation - matrix(epoch.R_itrs_gcrs)));
  }
  // The same library in another build: the last bits of sums of thousands of terms, arguments up to 1e4 rad.
  accuracy::expect_below("celestial pole X, Y and s", "IAU 2006/2000A, 12 epochs computed with ERFA", pole, 1e-14,
                         "rad");
  accuracy::expect_below("celestial pole by interpolation, at given epochs",
                         "IAU 2006/2000A, 12 epochs computed with ERFA", pole_interpolated, 1e-12, "rad");
  // Only rounding of the closed form of C(X, Y, s).
  accuracy::expect_below("rotation to ITRS from GCRS out of its parts", "IAU 2006/2000A, 12 epochs computed with ERFA",
                         rotation, 2e-15, "of a matrix element");
  accuracy::expect_below("rotation to ITRS from GCRS, pole by interpolation",
                         "IAU 2006/2000A, 12 epochs computed with ERFA", rotation_interpolated, 1e-12,
                         "of a matrix element");
}

TEST(EarthRotation, InterpolationErrorIsBelowItsStatement) {
  // 600 random instants of 2000 to 2020 against the full series; the claim is 1e-12 rad.
  CelestialPoleInterpolator interpolator;
  std::mt19937_64 random(20110718);
  std::uniform_real_distribution<double> day(0.0, 7305.0);
  accuracy::Largest largest;
  for (int i = 0; i < 600; ++i) {
    const JulianDate tt{2451544.5, day(random)};
    largest.add(largest_difference(interpolator.at(tt), celestial_pole_iau2006a(tt)));
  }
  accuracy::expect_below("celestial pole by interpolation", "ERFA's full series, 600 instants of 2000 to 2020", largest,
                         1e-12, "rad");
}

TEST(EarthRotation, InterpolationDoesNotDependOnEarlierCalls) {
  const JulianDate tt{2455760.5, 0.3};
  CelestialPoleInterpolator fresh, travelled;
  static_cast<void>(travelled.at({2455761.5, 0.9}));
  static_cast<void>(travelled.at({2455759.5, 0.1}));
  const CelestialPole a = fresh.at(tt), b = travelled.at(tt);
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.y, b.y);
  EXPECT_EQ(a.s, b.s);
}

TEST(EarthRotation, ErfasOwnNumber) {
  // eraC2t06a of ERFA's test program (t_erfa_c.c): TT = UT1 = MJD 53736.
  const JulianDate date{2400000.5, 53736.0};
  const fsw::Matrix3 R = R_itrf_gcrf(celestial_pole_iau2006a(date), eraEra00(date.day, date.fraction), 2.55060238e-7,
                                     1.860359247e-6, eraSp00(date.day, date.fraction));
  accuracy::expect_below("rotation to ITRS from GCRS with polar motion", "ERFA's own test of eraC2t06a, one element",
                         std::abs(R(0, 0) - -.1810332128305897282), 1e-12, "");  // the tolerance of ERFA's test
}

TEST(EarthRotation, RealEarthIsErfasChain) {
  // Without celestial pole offsets, which eraC2t06a does not know, the chain must be ERFA's to the interpolation error;
  // 1e-12 rad is 7 micrometres in low orbit.
  constexpr double kUt1MinusUtc = -0.2888, kPoleX = 0.13 * ERFA_DAS2R, kPoleY = 0.43 * ERFA_DAS2R;
  std::vector<EarthOrientationSeries::Day> days;
  for (int mjd = 55758; mjd < 55766; ++mjd) days.push_back({mjd, {kUt1MinusUtc - 34.0, kPoleX, kPoleY, 0.0, 0.0}});
  const fsw::GpsTime epoch = test::mission_epoch();
  EarthRotation rotation(std::make_shared<const EarthOrientationSeries>(days), epoch);
  accuracy::Largest largest;
  for (double seconds = 0.0; seconds < 148500.0; seconds += 3333.25) {
    double utc_day = 0.0, utc = 0.0, tai_day = 0.0, tai = 0.0, tt_day = 0.0, tt = 0.0, ut1_day = 0.0, ut1 = 0.0;
    eraDtf2d("UTC", 2011, 7, 18, 1, 0, 0.0, &utc_day, &utc);
    utc += seconds / kSecondsPerDay;
    eraUtctai(utc_day, utc, &tai_day, &tai);
    eraTaitt(tai_day, tai, &tt_day, &tt);
    eraUtcut1(utc_day, utc, kUt1MinusUtc, &ut1_day, &ut1);
    double x = 0.0, y = 0.0, expected[3][3];
    eraXy06(tt_day, tt, &x, &y);
    eraC2txy(tt_day, tt, ut1_day, ut1, x, y, kPoleX, kPoleY, expected);
    largest.add(accuracy::largest_entry(rotation.R_itrf_gcrf_at(seconds) - matrix(expected)));
  }
  accuracy::expect_below("Earth rotation from GPS time on, over 41 hours", "ERFA's chain from UTC, 45 instants",
                         largest, 1e-12, "of a matrix element");
}

TEST(EarthRotation, CelestialPoleOffsetsMoveThePole) {
  // To first order the third row of R is the pole's direction (X, Y, 1), whatever the rotation angle.
  std::vector<EarthOrientationSeries::Day> with, without;
  for (int mjd = 55758; mjd < 55766; ++mjd) {
    without.push_back({mjd, {-34.3, 0.0, 0.0, 0.0, 0.0}});
    with.push_back({mjd, {-34.3, 0.0, 0.0, 2e-9, -3e-9}});
  }
  EarthRotation moved(std::make_shared<const EarthOrientationSeries>(with), test::mission_epoch());
  EarthRotation still(std::make_shared<const EarthOrientationSeries>(without), test::mission_epoch());
  const fsw::Matrix3 difference = moved.R_itrf_gcrf_at(100.0) - still.R_itrf_gcrf_at(100.0);
  EXPECT_NEAR(difference(2, 0), 2e-9, 1e-15);
  EXPECT_NEAR(difference(2, 1), -3e-9, 1e-15);
}

TEST(EarthRotation, IsARotationAndTurnsEastward) {
  const auto series = std::make_shared<const EarthOrientationSeries>(
      EarthOrientationSeries::load(test::kDataDirectory / "earth/eop_2009_2013.csv"));
  EarthRotation rotation(series, test::mission_epoch());
  const fsw::Matrix3 R = rotation.R_itrf_gcrf_at(0.0);
  EXPECT_LT(accuracy::largest_entry(R * R.transpose() - fsw::Matrix3::Identity()), 1e-15);
  EXPECT_NEAR(R.determinant(), 1.0, 1e-15);
  // Nominal rate 7.292115e-5 rad/s (IERS Conventions 2010, table 1.2): the inertial x axis drifts westward in
  // longitude.
  const fsw::Matrix3 later = rotation.R_itrf_gcrf_at(100.0);
  const double turned = std::atan2(R(1, 0), R(0, 0)) - std::atan2(later(1, 0), later(0, 0));
  EXPECT_NEAR(turned, 7.292115e-3, 1e-8);
}

TEST(EarthRotation, RefusesWhatItHasNoDataFor) {
  EXPECT_THROW(EarthRotation(nullptr, test::mission_epoch()), std::invalid_argument);
  const auto series = std::make_shared<const EarthOrientationSeries>(
      EarthOrientationSeries::load(test::kDataDirectory / "earth/eop_2009_2013.csv"));
  EarthRotation rotation(series, gps_from_utc("2013-12-30T23:00:00Z"));
  EXPECT_NO_THROW(rotation.R_itrf_gcrf_at(3600.0));
  EXPECT_THROW(rotation.R_itrf_gcrf_at(3601.0), std::out_of_range);
}

}  // namespace
}  // namespace vbar::truth
