// Dates of GPS time against weeks and seconds of known instants.

#include "hil_drivers/grand/wire/calendar.h"

#include <gtest/gtest.h>

#include "tests/unit/hil_drivers/grand/wire/wire_test.h"

namespace vbar::grand::wire::test {
namespace {

fsw::GpsTime week(std::int64_t number, std::int64_t seconds) {
  return fsw::GpsTime{} + fsw::duration_of_seconds(number * 604800 + seconds);
}

// IS-GPS-200: week 0 begins on 1980-01-06, week 1024 on 1999-08-22, week 2048 on 2019-04-07.
TEST(Calendar, BeginsOfWeeks) {
  EXPECT_EQ(calendar_of(week(0, 0)), (Calendar{1980, 1, 6, 0, 0, 0}));
  EXPECT_EQ(calendar_of(week(1024, 0)), (Calendar{1999, 8, 22, 0, 0, 0}));
  EXPECT_EQ(calendar_of(week(2048, 0)), (Calendar{2019, 4, 7, 0, 0, 0}));
  // A Tuesday, in week 1645.
  EXPECT_EQ(calendar_of(week(1645, 2 * 86400 + 57600) + fsw::Duration{999'999'999}), (Calendar{2011, 7, 19, 16, 0, 0}));
}

TEST(Calendar, ReadsBack) {
  for (const fsw::GpsTime time : {week(0, 0), week(1642, 345599), week(2100, 86400)})
    EXPECT_EQ(time_of(calendar_of(time)), time);
}

TEST(Calendar, DatesThatDoNotExistAreRefused) {
  for (const Calendar& date :
       {Calendar{2011, 2, 29, 0, 0, 0}, Calendar{1980, 1, 5, 0, 0, 0}, Calendar{2200, 1, 1, 0, 0, 0},
        Calendar{2011, 13, 1, 0, 0, 0}, Calendar{2011, 1, 1, 24, 0, 0}, Calendar{2011, 1, 1, 0, 60, 0},
        Calendar{2011, 1, 1, 0, 0, 60}})
    EXPECT_NE(error_of([&] { time_of(date); }), "") << text_of(date);
}

}  // namespace
}  // namespace vbar::grand::wire::test
