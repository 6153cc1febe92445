#include "host_sim/truth/earth/earth_rotation.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <GeographicLib/Geocentric.hpp>
#include <erfa.h>
#include <erfam.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/truth/earth/earth_orientation.h"
#include "host_sim/truth/earth/time_scales.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

namespace vbar::truth::test {
namespace {

// Twelve epochs of the IAU 2006/2000A chain GCRS -> ITRS with zero Earth-orientation parameters, 1900 to 2100.
// Computed with pyerfa 2.0.1.5 (an independent build of ERFA), IERS Conventions 2010.

struct Iau2006Epoch {
  double tt_centuries;  ///< Julian centuries of TT since J2000.0
  double x, y, s;       ///< celestial intermediate pole and CIO locator, rad
  double era;           ///< Earth rotation angle, rad
  double sp;            ///< TIO locator s', rad
  double R_itrs_gcrs[3][3];
};

constexpr Iau2006Epoch kIau2006Epochs[] = {
    {-1.0,
     -0.00968409041373769,
     -0.00011891164818428993,
     -2.336591912459004e-07,
     4.903882945005279,
     2.278624301214819e-10,
     {{0.19031763338338975, -0.9817210489645033, 0.001726396067226841},
      {0.9816748019666209, 0.19032542625738474, 0.009529706382705807},
      {-0.009684090413737688, -0.00011891164818429084, 0.9999531010266824}}},
    {-0.5,
     -0.00486560232578934,
     1.3148395852330256e-05,
     6.443279169767077e-08,
     1.7578294253247435,
     1.1393121506074096e-10,
     {{-0.18594226255405474, 0.9825602439101705, -0.0009176510585998829},
      {-0.9825486252141857, -0.18594452644352308, -0.0047783025655237284},
      {-0.00486560232578934, 1.3148395852330541e-05, 0.9999881628005038}}},
    {-0.24,
     -0.0023053185600812737,
     -3.824149459374615e-05,
     -3.4048771766683844e-08,
     4.897102428547328,
     5.468698322915565e-11,
     {{0.18366445260050263, -0.9829889216047362, 0.00038581513136535427},
      {0.9829862940841517, 0.18366485385055561, 0.00227312620850086},
      {-0.0023053185600812737, -3.824149459374666e-05, 0.9999973420184299}}},
    {-0.1,
     -0.0009489899436852027,
     3.000348230774919e-05,
     2.1986568653928584e-08,
     1.754260732452103,
     2.278624301214819e-11,
     {{-0.1824368081554675, 0.9832175598364937, -0.00020263073829280244},
      {-0.9832171227394955, -0.1824369182182214, -0.0009275898371937617},
      {-0.0009489899436852026, 3.0003482307749322e-05, 0.9999995492588374}}},
    {-0.01,
     -0.00011603892967402302,
     -3.952598261042313e-05,
     -9.217727613953822e-09,
     3.324254103350675,
     2.2786243012148192e-12,
     {{-0.9833637219881207, -0.18164739350408157, -0.00012128826640795587},
      {0.18164739693328127, -0.9833637286736125, -1.779024825473372e-05},
      {-0.00011603892967402303, -3.952598261042315e-05, 0.9999999924863318}}},
    {0.0,
     -2.6946379568574036e-05,
     -2.8004722822812816e-05,
     -1.0133965191775003e-08,
     4.894961212823756,
     -0.0,
     {{0.1815596633039061, -0.983379930722653, -2.2646906804777836e-05},
      {0.9833799306142387, 0.18155966255654263, 3.158305691999976e-05},
      {-2.6946379568574036e-05, -2.8004722822812813e-05, 0.9999999992448141}}},
    {0.01,
     6.599307330262272e-05,
     -1.4034669102666868e-05,
     -1.1084938908675307e-08,
     0.18248301511725273,
     -2.2786243012148192e-12,
     {{0.9833961231633943, 0.18147192912301757, -6.235043410668411e-05},
      {-0.1814719278349145, 0.9833961250398531, 2.5777529506427326e-05},
      {6.599307330262274e-05, -1.403466910266687e-05, 0.9999999977239712}}},
    {0.1,
     0.0010033080235519703,
     1.2487218189628634e-05,
     7.766920280089076e-09,
     1.7524763860158217,
     -2.278624301214819e-11,
     {{-0.18068214321180684, 0.9835415266088087, 0.00016899823142793534},
      {-0.9835410293919608, -0.1806822218152176, 0.0009890513224884271},
      {0.0010033080235519706, 1.2487218189628636e-05, 0.9999994966084129}}},
    {0.2,
     0.0019112632337172234,
     -1.2426055860646423e-05,
     7.184183345898506e-10,
     4.893176866387478,
     -4.557248602429638e-11,
     {{0.17980433361278042, -0.9837023304664863, -0.0003558776022313038},
      {0.9837005381145804, 0.17980468536831, -0.0018778798384490865},
      {0.0019112632337172234, -1.2426055860646423e-05, 0.9999981734575542}}},
    {0.24,
     0.002321618228656644,
     3.29500207186049e-05,
     -4.290450842206577e-08,
     4.892819997100219,
     -5.468698322915565e-11,
     {{0.1794532060218699, -0.9837664353050883, -0.0003842077454984577},
      {0.9837637709009579, 0.17945361428908455, -0.0022898430758013007},
      {0.002321618228656644, 3.29500207186049e-05, 0.9999973044979154}}},
    {0.5,
     0.004886533763528367,
     -5.3418319902025235e-05,
     1.0583661601904095e-07,
     1.7489076931432166,
     -1.1393121506074096e-10,
     {{-0.17716878692872925, 0.9841800534539067, 0.0009183254694681114},
      {-0.9841683508048714, -0.17717115885478776, 0.0047997650016568544},
      {0.004886533763528367, -5.3418319902025235e-05, 0.9999880593958415}}},
    {1.0,
     0.00972070446172924,
     -6.730586996167199e-05,
     -4.805119345338698e-09,
     4.886039480642268,
     -2.278624301214819e-10,
     {{0.17277061021605467, -0.9849605415089568, -0.0017458281570904646},
      {0.9849141201903543, 0.17277941758294546, -0.009562881854248969},
      {0.009720704461729242, -6.7305869961672e-05, 0.9999527505710896}}},
};

}  // namespace
}  // namespace vbar::truth::test

namespace vbar::truth {
namespace {

constexpr double kArcsec = M_PI / 180.0 / 3600.0;

EarthOrientationSeries real_series() {
  return EarthOrientationSeries::load(test::kDataDirectory / "earth/eop_2009_2013.csv");
}

TEST(EarthOrientation, GivesTheIersValuesAtMidnight) {
  // IERS EOP 14 C04, row of 2011-07-18 (MJD 55760): printed to 1e-6 arcsec and 1e-7 s.
  const EarthOrientation o = real_series().at(gps_from_utc("2011-07-18T00:00:00Z"));
  EXPECT_NEAR(o.pole_x / kArcsec, 0.076529, 1e-12);
  EXPECT_NEAR(o.pole_y / kArcsec, 0.447250, 1e-12);
  EXPECT_NEAR(o.ut1_minus_tai_s + 34.0, -0.2914350, 1e-12);
  EXPECT_NEAR(o.cip_dx / kArcsec, -0.000176, 1e-12);
  EXPECT_NEAR(o.cip_dy / kArcsec, 0.000104, 1e-12);
}

TEST(EarthOrientation, AgreesWithTheOtherServiceBetweenMidnights) {
  // USNO finals2000A (Bulletin A final values), 2011-07-18 and 19, mean of the two days: the services agree to about
  // 0.1 mas and 20 us, and UT1 bends by less than 0.1 ms over half a day.
  const EarthOrientation o = real_series().at(gps_from_utc("2011-07-18T12:00:00Z"));
  EXPECT_NEAR(o.pole_x / kArcsec, 0.5 * (0.076541 + 0.07869), 5e-4);
  EXPECT_NEAR(o.pole_y / kArcsec, 0.5 * (0.447175 + 0.447627), 5e-4);
  EXPECT_NEAR(o.ut1_minus_tai_s + 34.0, 0.5 * (-0.2914214 + -0.2915911), 1e-4);
}

TEST(EarthOrientation, Ut1RunsOnThroughALeapSecond) {
  const EarthOrientationSeries series = real_series();
  const fsw::GpsTime leap = gps_from_utc("2012-06-30T23:59:60Z");
  const double before = series.at(leap, -1.0).ut1_minus_tai_s;
  const double after = series.at(leap, 2.0).ut1_minus_tai_s;
  // The length of day exceeds 86400 s by at most 2 ms in these years: 3 s of it are below 1e-7 s.
  EXPECT_NEAR(after, before, 1e-7);
}

TEST(EarthOrientation, ReproducesACubicWhateverTheDay) {
  // A Lagrange polynomial through four points is exact for cubics; 1e-9 is rounding of numbers up to 1e3.
  constexpr int kFirstMjd = 56100;  // 56108 (2012-06-30) has a leap second
  const auto seconds = [&](int mjd) { return 86400.0 * (mjd - kFirstMjd) + (mjd > 56108 ? 1.0 : 0.0); };
  const auto cubic = [](double s) { return 3.0 - 2e-5 * s + 3e-11 * s * s + 4e-16 * s * s * s; };
  std::vector<EarthOrientationSeries::Day> days;
  for (int mjd = kFirstMjd; mjd < kFirstMjd + 20; ++mjd) {
    const double value = cubic(seconds(mjd));
    days.push_back({mjd, {value, 2.0 * value, 3.0 * value, 4.0 * value, 5.0 * value}});
  }
  const EarthOrientationSeries series(days);
  const fsw::GpsTime start = gps_from_utc("2012-06-22T00:00:00Z");
  for (double s = 0.0; s <= seconds(kFirstMjd + 19); s += 10007.0) {
    const EarthOrientation o = series.at(start, s);
    EXPECT_NEAR(o.ut1_minus_tai_s, cubic(s), 1e-9) << s;
    EXPECT_NEAR(o.pole_x, 2.0 * cubic(s), 1e-9) << s;
    EXPECT_NEAR(o.pole_y, 3.0 * cubic(s), 1e-9) << s;
    EXPECT_NEAR(o.cip_dx, 4.0 * cubic(s), 1e-9) << s;
    EXPECT_NEAR(o.cip_dy, 5.0 * cubic(s), 1e-9) << s;
  }
}

TEST(EarthOrientation, RefusesDatesOutsideTheData) {
  const EarthOrientationSeries series = real_series();
  EXPECT_NO_THROW(series.at(gps_from_utc("2009-01-01T00:00:00Z")));
  EXPECT_NO_THROW(series.at(gps_from_utc("2013-12-31T00:00:00Z")));
  EXPECT_THROW(series.at(gps_from_utc("2008-12-31T23:59:59Z")), std::out_of_range);
  EXPECT_THROW(series.at(gps_from_utc("2013-12-31T00:00:00Z"), 0.001), std::out_of_range);
  EXPECT_THROW(series.at({0}, -1e300), std::out_of_range);
  try {
    static_cast<void>(series.at(gps_from_utc("2020-05-01T00:00:00Z")));
    FAIL();
  } catch (const std::out_of_range& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("2020-05-01T00:00:00Z"));
    EXPECT_THAT(error.what(), testing::HasSubstr("from 2009-01-01T00:00:00Z to 2013-12-31T00:00:00Z"));
  }
}

class EarthOrientationFile : public testing::Test {
 protected:
  std::string message_for(const std::string& text) {
    const auto path = std::filesystem::path(testing::TempDir()) / (std::to_string(::getpid()) + "_vbar_eop_test.csv");
    std::ofstream(path) << text;
    try {
      static_cast<void>(EarthOrientationSeries::load(path));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  const std::string header_ = "# comment\nmjd_utc,x_arcsec,y_arcsec,ut1_minus_utc_s,dx_arcsec,dy_arcsec\n";
  const std::string rows_ = "55000,0,0,0,0,0\n55001,0,0,0,0,0\n55002,0,0,0,0,0\n55003,0,0,0,0,0\n";
};

TEST_F(EarthOrientationFile, IsReadWhenWhole) {
  EXPECT_EQ(message_for(header_ + rows_), "");
}

TEST_F(EarthOrientationFile, ErrorsNameFileAndLine) {
  using testing::HasSubstr;
  EXPECT_THAT(message_for("a,b\n"),
              HasSubstr("vbar_eop_test.csv:1: found \"a,b\", expected Earth orientation in one of the formats"));
  EXPECT_THAT(message_for("mjd_utc,b\n"), HasSubstr(":1: found \"mjd_utc,b\", expected the columns"));
  EXPECT_THAT(message_for(header_ + rows_ + "55005,0,0,0,0,0\n"), HasSubstr(":7: day 55005 follows day 55003"));
  EXPECT_THAT(message_for(header_ + rows_ + "55004,0,0,0,0\n"),
              HasSubstr(":7: found \"55004,0,0,0,0\", expected a whole MJD from 1980 to 2099 and 5 numbers"));
  EXPECT_THAT(message_for(header_ + rows_ + "55004,0,0,0,0,0,0\n"),
              HasSubstr("expected a whole MJD from 1980 to 2099 and 5 numbers"));
  EXPECT_THAT(message_for(header_ + rows_ + "55004,0,0,nan,0,0\n"),
              HasSubstr("expected a whole MJD from 1980 to 2099 and 5 numbers"));
  EXPECT_THAT(message_for(header_ + rows_ + "55004.5,0,0,0,0,0\n"),
              HasSubstr("expected a whole MJD from 1980 to 2099 and 5 numbers"));
  EXPECT_THAT(message_for(header_ + rows_ + "1e99,0,0,0,0,0\n"),
              HasSubstr("expected a whole MJD from 1980 to 2099 and 5 numbers"));
  EXPECT_THAT(message_for(header_ + "55000,0,0,0,0,0\n"), HasSubstr("1 days of Earth orientation"));
  EXPECT_THROW(EarthOrientationSeries::load("/nonexistent/eop.csv"), std::runtime_error);
}

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

constexpr double kDegree = M_PI / 180.0;

TEST(Geodetic, AgreesWithGeographicLib) {
  // Karney's conversion is exact (a quartic solved in closed form; here from geodetic to Cartesian, a plain formula).
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  accuracy::Largest angle, height;
  for (int i = 0; i < 20000; ++i) {
    const double latitude_deg = -90.0 + 180.0 * unit(random);
    const double longitude_deg = -180.0 + 360.0 * unit(random);
    const double altitude = 3.6e7 * std::pow(unit(random), 3);
    fsw::Vector3 r;
    GeographicLib::Geocentric::WGS84().Forward(latitude_deg, longitude_deg, altitude, r.x(), r.y(), r.z());
    const GeodeticPosition found = geodetic_from_itrf(r);
    angle.add(std::abs(found.latitude - latitude_deg * kDegree));
    angle.add(std::abs(found.longitude - longitude_deg * kDegree));
    height.add(std::abs(found.altitude - altitude));
  }
  // Rounding: 2e-16 of pi, and of 4e7 m; Bowring's second pass is below it.
  accuracy::expect_below("geodetic latitude and longitude", "GeographicLib Geocentric, 20,000 points to geostationary",
                         angle, 2e-15, "rad");
  accuracy::expect_below("geodetic altitude", "GeographicLib Geocentric, 20,000 points to geostationary", height, 3e-8,
                         "m");
}

TEST(Geodetic, HoldsAtPolesAndEquator) {
  const double polar_radius = 6356752.314245179;  // WGS 84, NIMA TR8350.2
  const GeodeticPosition north = geodetic_from_itrf({0.0, 0.0, polar_radius + 500e3});
  EXPECT_EQ(north.latitude, M_PI / 2.0);
  EXPECT_NEAR(north.altitude, 500e3, 2e-9);  // last place of 7e6
  EXPECT_EQ(geodetic_from_itrf({0.0, 0.0, -polar_radius}).latitude, -M_PI / 2.0);
  const GeodeticPosition west = geodetic_from_itrf({0.0, -6378137.0, 0.0});
  EXPECT_EQ(west.latitude, 0.0);
  EXPECT_EQ(west.longitude, -M_PI / 2.0);
  EXPECT_NEAR(west.altitude, 0.0, 2e-9);
}

TEST(Geodetic, NoNumberGivesNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(geodetic_from_itrf({nan, 0.0, 7e6}).altitude));
}

}  // namespace

}  // namespace vbar::truth
