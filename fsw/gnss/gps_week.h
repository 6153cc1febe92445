#pragma once
// Weeks and seconds of week of receivers and navigation messages, converted to the one clock (core/gps_time.h).

#include <cstdint>

#include "fsw/core/gps_time.h"

namespace vbar::fsw::gnss {

inline constexpr std::int64_t kSecondsPerWeek = 604'800;
inline constexpr std::int64_t kNanosecondsPerWeek = kSecondsPerWeek * kNanosecondsPerSecond;
/// Largest week, in the year 2171: far below the range of an instant in nanoseconds (15,250 weeks).
inline constexpr std::uint32_t kMaxWeek = 10'000;

/// BeiDou time began on 2006-01-01 UTC: GPS week 1356, and 14 s behind GPS time ever since
/// (BDS-SIS-ICD-B1I-3.0, 3.3).
inline constexpr std::int64_t kBeidouFirstGpsWeek = 1356;
inline constexpr Duration kGpsMinusBeidouTime = duration_of_seconds(14);

/// Returns the beginning of week `week` (at most kMaxWeek) of GPS, without rollover.
constexpr GpsTime start_of_week(std::int64_t week) {
  return {week * kNanosecondsPerWeek};
}

/// Returns the time since the week began.
constexpr Duration time_of_week(GpsTime time) {
  const std::int64_t rest = time.ns % kNanosecondsPerWeek;
  return {rest < 0 ? rest + kNanosecondsPerWeek : rest};
}

/// Returns the instant with this time of week that is nearest to `near`: at most half a week away.
constexpr GpsTime nearest_with_time_of_week(GpsTime near, Duration of_week) {
  std::int64_t ahead = (of_week.ns - time_of_week(near).ns) % kNanosecondsPerWeek;
  if (ahead >= kNanosecondsPerWeek / 2) ahead -= kNanosecondsPerWeek;
  if (ahead < -kNanosecondsPerWeek / 2) ahead += kNanosecondsPerWeek;
  return {near.ns + ahead};
}

}  // namespace vbar::fsw::gnss
