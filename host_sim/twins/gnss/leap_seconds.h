#pragma once
// UTC parameters of the satellites: the offset in seconds, and the last leap second.

#include "fsw/core/gps_time.h"

namespace vbar::twins::gnss {

struct UtcOffset {
  int gps_minus_utc_s = 0;
  int change_week = 0;  ///< GPS week of the day at whose end the offset last changed
  int change_day = 1;   ///< that day of the week, 1 to 7 (Sunday is 1)
};

/// Returns the offset at `time`. Looks back for the last change for ten years, then returns week 0, day 1. Throws
/// std::out_of_range before 1980-01-06.
UtcOffset utc_offset_at(fsw::GpsTime time);

struct CalendarTime {
  int year = 0;
  unsigned month = 0, day = 0, hour = 0, minute = 0;
  unsigned millisecond = 0;  ///< milliseconds of the minute
};
/// Returns UTC of `time`, cut to milliseconds, for an offset that holds then.
CalendarTime utc_calendar(fsw::GpsTime time, const UtcOffset& offset);

}  // namespace vbar::twins::gnss
