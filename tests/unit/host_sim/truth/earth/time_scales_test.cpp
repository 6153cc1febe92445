#include "host_sim/truth/earth/time_scales.h"

#include <cstdint>
#include <stdexcept>

#include <erfa.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::truth {

namespace {

constexpr std::int64_t kSecond = fsw::kNanosecondsPerSecond;

TEST(TimeScales, GpsTimeBeginsAtItsEpoch) {
  EXPECT_EQ(gps_from_utc("1980-01-06T00:00:00Z").ns, 0);
}

TEST(TimeScales, MissionEpoch) {
  const fsw::GpsTime epoch = gps_from_utc("2011-07-18T01:00:00Z");
  // Monday of GPS week 1645, GPS 15 s ahead of UTC since 2009 (IS-GPS-200 calendar; IERS Bulletin C 36).
  EXPECT_EQ(epoch.ns, ((1645 * 7 + 1) * std::int64_t{86400} + 3600 + 15) * kSecond);
  EXPECT_EQ(format_utc(epoch), "2011-07-18T01:00:00.000Z");
  const JulianDate utc = utc_of(epoch);
  EXPECT_NEAR((utc.day - 2455760.0) + utc.fraction, 0.541666667, 5e-10);  // JD 2455760.541666667, half a printed digit
  // TT - UTC = 66.184 s in 2011; 1e-10 s is the resolution of the Julian date's fraction of half a day.
  const JulianDate tt = tt_of(epoch);
  EXPECT_NEAR(((tt.day - utc.day) + (tt.fraction - utc.fraction)) * kSecondsPerDay, 66.184, 1e-10);
}

TEST(TimeScales, GpsIsEighteenSecondsAheadSince2017) {
  // Saturday of GPS week 2190, as an SP3 file of 2022-01-01T00:00:00 GPS time says: "2190 518400.0".
  EXPECT_EQ(gps_from_utc("2021-12-31T23:59:42Z").ns, (2190 * std::int64_t{604800} + 518400) * kSecond);
}

TEST(TimeScales, EarthRotationAngleAndSiderealTimeOfTheMissionEpoch) {
  // Computed independently with ERFA at the mission epoch: ERA 310.349033 deg, GMST06 310.496907 deg with UT1-UTC =
  // -0.3 s; half a printed digit.
  const fsw::GpsTime epoch = gps_from_utc("2011-07-18T01:00:00Z");
  const JulianDate ut1 = ut1_of(tai_of(epoch), -0.3 - 34.0);
  const JulianDate tt = tt_of(epoch);
  EXPECT_NEAR(eraEra00(ut1.day, ut1.fraction) * 180.0 / M_PI, 310.349033, 5e-7);
  EXPECT_NEAR(eraGmst06(ut1.day, ut1.fraction, tt.day, tt.fraction) * 180.0 / M_PI, 310.496907, 5e-7);
}

TEST(TimeScales, ErfaIsTheLibraryItShouldBe) {
  // Numbers of ERFA's own test program (t_erfa_c.c).
  EXPECT_NEAR(eraEra00(2400000.5, 54388.0), .4022837240028158102, 1e-12);
}

TEST(TimeScales, LeapSecondsOfTheIersList) {
  // IERS leap-seconds.list (Bulletin C 66): first day of a TAI-UTC, s.
  constexpr struct {
    int mjd, tai_minus_utc;
  } kList[] = {{44239, 19}, {44786, 20}, {45151, 21}, {45516, 22}, {46247, 23}, {47161, 24}, {47892, 25},
               {48257, 26}, {48804, 27}, {49169, 28}, {49534, 29}, {50083, 30}, {50630, 31}, {51179, 32},
               {53736, 33}, {54832, 34}, {56109, 35}, {57204, 36}, {57754, 37}};
  for (const auto& entry : kList) {
    EXPECT_EQ(tai_minus_utc_s(entry.mjd), entry.tai_minus_utc) << entry.mjd;
    EXPECT_EQ(tai_minus_utc_s(entry.mjd - 1), entry.tai_minus_utc - 1) << entry.mjd;
    EXPECT_EQ(first_day_of_tai_minus_utc(entry.mjd), entry.mjd);
    EXPECT_EQ(first_day_of_tai_minus_utc(entry.mjd + 100), entry.mjd);
  }
}

TEST(TimeScales, ALeapSecondIsASecond) {
  const fsw::GpsTime last = gps_from_utc("2012-06-30T23:59:59Z");
  const fsw::GpsTime leap = gps_from_utc("2012-06-30T23:59:60Z");
  const fsw::GpsTime next = gps_from_utc("2012-07-01T00:00:00Z");
  EXPECT_EQ((leap - last).ns, kSecond);
  EXPECT_EQ((next - leap).ns, kSecond);
  EXPECT_EQ(format_utc(leap, 0), "2012-06-30T23:59:60Z");
  EXPECT_EQ(format_utc(next, 0), "2012-07-01T00:00:00Z");
}

TEST(TimeScales, TextToANanosecondAndBack) {
  for (const char* text :
       {"1980-01-06T00:00:00.000000001Z", "2011-07-18T01:00:00.123456789Z", "2008-12-31T23:59:60.999999999Z",
        "2012-02-29T12:34:56.700000000Z", "2024-11-05T23:59:59.999999999Z"}) {
    EXPECT_EQ(format_utc(gps_from_utc(text), 9), text);
  }
  EXPECT_EQ(gps_from_utc("2011-07-18 01:00:00"), gps_from_utc("2011-07-18T01:00:00.0Z"));
}

TEST(TimeScales, RefusesWhatIsNoUtcTime) {
  for (const char* text : {"",
                           "2011-07-18",
                           "2011-07-18T01:00",
                           "2011-7-18T01:00:00",
                           "2011-02-29T00:00:00",
                           "2011-13-01T00:00:00",
                           "2011-07-18T24:00:00",
                           "2011-07-18T01:60:00",
                           "2011-07-18T01:00:60",
                           "2011-06-30T23:59:60",
                           "2012-06-30T23:59:61",
                           "2012-06-30T22:59:60",
                           "2011-07-18T01:00:00.",
                           "2011-07-18T01:00:00.1234567890",
                           "2011-07-18T01:00:00+02:00",
                           "2011-07-18T01:00:00ZZ",
                           "-011-07-18T01:00:00",
                           "1979-12-31T00:00:00",
                           "3342-07-18T01:00:00Z",
                           "1980-01-05T23:59:59",
                           "nonsense"}) {
    EXPECT_THROW(gps_from_utc(text), std::invalid_argument) << text;
  }
  try {
    gps_from_utc("yesterday");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("\"yesterday\""));
    EXPECT_THAT(error.what(), testing::HasSubstr("YYYY-MM-DDThh:mm:ss"));
  }
}

TEST(TimeScales, RefusesTimesWithoutUtc) {
  EXPECT_THROW(utc_of({-1}), std::out_of_range);
  EXPECT_THROW(tai_minus_utc_s(40000), std::out_of_range);
  EXPECT_THROW(format_utc({0}, 10), std::invalid_argument);
}

}  // namespace

namespace {

TEST(UtcDay, MidnightsAreThoseOfTheCalendar) {
  // Modified Julian days of the IERS bulletins: 2011-07-18 is 55760.
  EXPECT_EQ(midnight_utc(55760), gps_from_utc("2011-07-18T00:00:00Z"));
  EXPECT_EQ(midnight_utc(44244), gps_from_utc("1980-01-06T00:00:00Z"));
  EXPECT_EQ(mjd_utc_of(gps_from_utc("2011-07-18T00:00:00Z")), 55760);
  EXPECT_EQ(mjd_utc_of(gps_from_utc("2011-07-18T23:59:59.999999999Z")), 55760);
  EXPECT_EQ(mjd_utc_of(gps_from_utc("2011-07-19T00:00:00Z")), 55761);
  EXPECT_EQ(mjd_utc_of({0}), 44244);
  EXPECT_THROW(mjd_utc_of({-1}), std::out_of_range);
}

TEST(UtcDay, LeapSecondBelongsToItsDay) {
  // After 2012-06-30 (MJD 56108).
  EXPECT_EQ(mjd_utc_of(gps_from_utc("2012-06-30T23:59:60.999999999Z")), 56108);
  EXPECT_EQ(mjd_utc_of(gps_from_utc("2012-07-01T00:00:00Z")), 56109);
  EXPECT_EQ(midnight_utc(56109) - midnight_utc(56108), fsw::duration_of_seconds(86401));
}

TEST(UtcDay, DayOfYearCountsFromOne) {
  EXPECT_EQ(day_of_year(55760), 199);  // 18 July of a common year: 181 + 18
  EXPECT_EQ(day_of_year(55562), 1);    // 2011-01-01
  EXPECT_EQ(day_of_year(55561), 365);
  EXPECT_EQ(day_of_year(56292), 366);  // 2012-12-31, leap year
}

}  // namespace

}  // namespace vbar::truth
