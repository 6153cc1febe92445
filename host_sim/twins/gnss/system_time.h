#pragma once
// Weeks and seconds of week as the systems count them.

#include "fsw/core/gps_time.h"
#include "host_sim/twins/gnss/satellite.h"

namespace vbar::twins::gnss {

inline constexpr std::int64_t kSecondsPerWeek = 604800;

struct WeekTime {
  int week = 0;
  std::int64_t ns_of_week = 0;
  [[nodiscard]] double seconds_of_week() const { return static_cast<double>(ns_of_week) / 1e9; }
};

/// Returns GPS time minus the system's own time: BeiDou time began on 2006-01-01 UTC, when GPS-UTC was 14 s. Galileo
/// and GPS time are taken as equal (their real offset of nanoseconds is inseparable from a receiver's code bias).
constexpr fsw::Duration gps_minus_system_time(System system) {
  return fsw::duration_of_seconds(system == System::kBeidou ? 14 : 0);
}

/// Returns week and seconds of `time`, not before 2006-01-01 GPS + 14 s for BeiDou, in the system's own weeks;
/// Galileo's are counted like GPS's, as receivers write them.
constexpr WeekTime week_time(System system, fsw::GpsTime time) {
  constexpr int kGpsWeekOfBeidouZero = 1356;
  const std::int64_t ns = (time - gps_minus_system_time(system)).ns;
  const std::int64_t week_ns = kSecondsPerWeek * fsw::kNanosecondsPerSecond;
  const int week = static_cast<int>(ns / week_ns) - (system == System::kBeidou ? kGpsWeekOfBeidouZero : 0);
  return {week, ns % week_ns};
}

constexpr fsw::GpsTime gps_time_of(System system, int week, std::int64_t seconds_of_week) {
  const int gps_week = week + (system == System::kBeidou ? 1356 : 0);
  return fsw::GpsTime{} + fsw::duration_of_seconds(gps_week * kSecondsPerWeek + seconds_of_week) +
         gps_minus_system_time(system);
}

// UTC parameters of the satellites: the offset in seconds, and the last leap second.

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
