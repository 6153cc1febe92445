#include "host_sim/truth/earth/earth_orientation.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/truth/earth/time_scales.h"
#include "tests/unit/host_sim/truth/truth_fixture.h"

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

}  // namespace
}  // namespace vbar::truth
