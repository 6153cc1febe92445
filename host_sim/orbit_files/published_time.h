#pragma once
// Instants as orbit files write them.

#include <optional>
#include <string_view>

#include "fsw/core/gps_time.h"

namespace vbar::orbit_files {

enum class TimeSystem { kUtc, kTai, kTt, kGps, kBeidou };

/// Returns a time system by its name in OEM, OPM and SP3; nothing for another.
[[nodiscard]] std::optional<TimeSystem> time_system_named(std::string_view name);

/// A calendar time. `month` 0: `day` is that of the year.
struct Calendar {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0;
  double second = 0.0;  ///< rounded to nanoseconds
};

/// Returns the instant of a calendar time; nothing for a time that does not exist, or not from 1980 to 2200.
[[nodiscard]] std::optional<fsw::GpsTime> instant_of(const Calendar& calendar, TimeSystem system);

/// Returns the instant of fields that may have reached the next minute, hour or day: 60 s, 60 min, 24 h, as some
/// programs write them. 60 s are a leap second where there was one.
[[nodiscard]] std::optional<fsw::GpsTime> instant_of_carried(Calendar calendar, TimeSystem system);

/// Parses a time of CCSDS: YYYY-MM-DDThh:mm:ss or YYYY-DDDThh:mm:ss, decimals and Z behind it allowed. Nothing for
/// another text.
[[nodiscard]] std::optional<fsw::GpsTime> ccsds_time(std::string_view text, TimeSystem system);

}  // namespace vbar::orbit_files
