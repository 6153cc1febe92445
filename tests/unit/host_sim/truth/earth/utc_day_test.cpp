#include "host_sim/truth/earth/utc_day.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "host_sim/truth/earth/time_scales.h"

namespace vbar::truth {
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
