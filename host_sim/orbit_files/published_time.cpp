#include "host_sim/orbit_files/published_time.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include <erfa.h>

#include "host_sim/files/text_lines.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::orbit_files {
namespace {

constexpr int kMjdOfGpsEpoch = 44244;

/// GPS time less the time system, of those without leap seconds.
std::int64_t offset_ns(TimeSystem system) {
  constexpr std::int64_t kMillisecond = 1000000;
  switch (system) {
    case TimeSystem::kUtc:
    case TimeSystem::kGps:
      return 0;
    case TimeSystem::kTai:
      return -19000 * kMillisecond;
    case TimeSystem::kTt:
      return -51184 * kMillisecond;
    case TimeSystem::kBeidou:
      return 14000 * kMillisecond;
  }
  return 0;
}

std::optional<int> mjd_of(const Calendar& c) {
  double zero = 0.0, mjd = 0.0;
  const bool by_day_of_year = c.month == 0;
  if (c.year < 1980 || c.year > 2200 ||
      eraCal2jd(c.year, by_day_of_year ? 1 : c.month, by_day_of_year ? 1 : c.day, &zero, &mjd) != 0)
    return std::nullopt;
  if (!by_day_of_year) return static_cast<int>(mjd);
  const bool is_leap_year = c.year % 4 == 0 && (c.year % 100 != 0 || c.year % 400 == 0);
  if (c.day < 1 || c.day > (is_leap_year ? 366 : 365)) return std::nullopt;
  return static_cast<int>(mjd) + c.day - 1;
}

bool has_leap_second(int mjd) {
  return truth::tai_minus_utc_s(mjd + 1) > truth::tai_minus_utc_s(mjd);
}

}  // namespace

std::optional<TimeSystem> time_system_named(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, TimeSystem>, 6> kNames{{{"UTC", TimeSystem::kUtc},
                                                                           {"TAI", TimeSystem::kTai},
                                                                           {"TT", TimeSystem::kTt},
                                                                           {"GPS", TimeSystem::kGps},
                                                                           {"GAL", TimeSystem::kGps},
                                                                           {"BDT", TimeSystem::kBeidou}}};
  for (const auto& [known, system] : kNames)
    if (known == name) return system;
  return std::nullopt;
}

namespace {

/// `mjd` is that of its day, instead of the date.
std::optional<fsw::GpsTime> instant_on(std::optional<int> mjd, const Calendar& c, TimeSystem system) {
  if (!mjd || c.hour < 0 || c.hour > 23 || c.minute < 0 || c.minute > 59) return std::nullopt;
  const bool may_leap = system == TimeSystem::kUtc && c.hour == 23 && c.minute == 59 && has_leap_second(*mjd);
  if (!(c.second >= 0.0 && c.second < (may_leap ? 61.0 : 60.0))) return std::nullopt;
  const std::int64_t whole_s = 3600 * c.hour + 60 * c.minute;
  const std::int64_t of_day_ns = whole_s * fsw::kNanosecondsPerSecond + std::llround(c.second * 1e9);
  fsw::GpsTime time;
  if (system == TimeSystem::kUtc) {
    time = truth::midnight_utc(*mjd) + fsw::Duration{of_day_ns};
  } else {
    constexpr std::int64_t kSecondsPerDay = 86400;
    time.ns = (*mjd - kMjdOfGpsEpoch) * kSecondsPerDay * fsw::kNanosecondsPerSecond + of_day_ns + offset_ns(system);
  }
  if (time.ns < 0) return std::nullopt;
  return time;
}

}  // namespace

std::optional<fsw::GpsTime> instant_of(const Calendar& calendar, TimeSystem system) {
  return instant_on(mjd_of(calendar), calendar, system);
}

std::optional<fsw::GpsTime> instant_of_carried(Calendar c, TimeSystem system) {
  auto mjd = mjd_of(c);
  if (const auto as_written = instant_on(mjd, c, system)) return as_written;
  if (c.hour == 24 && (c.minute != 0 || c.second != 0.0)) return std::nullopt;
  if (c.second >= 60.0 && c.second < 61.0) {
    c.second -= 60.0;
    ++c.minute;
  }
  if (c.minute == 60) {
    c.minute = 0;
    ++c.hour;
  }
  if (c.hour == 24 && mjd) {
    c.hour = 0;
    ++*mjd;
  }
  return instant_on(mjd, c, system);
}

std::optional<fsw::GpsTime> ccsds_time(std::string_view text, TimeSystem system) {
  if (text.ends_with('Z')) text.remove_suffix(1);
  const auto day_and_clock = files::split_at(text, 'T');
  if (day_and_clock.size() != 2) return std::nullopt;
  const auto date = files::split_at(day_and_clock[0], '-'), clock = files::split_at(day_and_clock[1], ':');
  if ((date.size() != 2 && date.size() != 3) || clock.size() != 3) return std::nullopt;
  const bool by_day_of_year = date.size() == 2;
  const auto year = files::integer_of(date[0]), day = files::integer_of(date.back());
  const auto month = by_day_of_year ? std::optional(0) : files::integer_of(date[1]);
  const auto hour = files::integer_of(clock[0]), minute = files::integer_of(clock[1]);
  const auto second = files::number_of(clock[2]);
  if (!year || !month || !day || !hour || !minute || !second || (!by_day_of_year && *month == 0)) return std::nullopt;
  return instant_of({*year, *month, *day, *hour, *minute, *second}, system);
}

}  // namespace vbar::orbit_files
