#include "host_sim/twins/gnss/system_time.h"

#include <chrono>
#include <cmath>

#include "host_sim/truth/earth/time_scales.h"

namespace vbar::twins::gnss {
namespace {

constexpr int kGpsEpoch_mjd = 44244;
constexpr int kTaiMinusGps_s = 19;
constexpr int kDaysToSearch = 3653;
constexpr std::int64_t kSecondsPerDay = 86400;

int gps_minus_utc_s(int mjd_utc) {
  return static_cast<int>(std::lround(truth::tai_minus_utc_s(mjd_utc))) - kTaiMinusGps_s;
}

}  // namespace

UtcOffset utc_offset_at(fsw::GpsTime time) {
  const std::int64_t gps_s = time.ns / fsw::kNanosecondsPerSecond;
  const int about_day = kGpsEpoch_mjd + static_cast<int>(gps_s / kSecondsPerDay);
  // The UTC day may still be the day before.
  const int day = kGpsEpoch_mjd + static_cast<int>((gps_s - gps_minus_utc_s(about_day)) / kSecondsPerDay);
  UtcOffset offset;
  offset.gps_minus_utc_s = gps_minus_utc_s(day);
  const int last_before = truth::first_day_of_tai_minus_utc(day) - 1;
  if (last_before >= kGpsEpoch_mjd && last_before > day - kDaysToSearch) {
    offset.change_week = (last_before - kGpsEpoch_mjd) / 7;
    offset.change_day = (last_before - kGpsEpoch_mjd) % 7 + 1;
  }
  return offset;
}

CalendarTime utc_calendar(fsw::GpsTime time, const UtcOffset& offset) {
  namespace chrono = std::chrono;
  using chrono::milliseconds;
  constexpr chrono::sys_days kGpsEpoch = chrono::year{1980} / chrono::January / 6;
  const auto utc = kGpsEpoch + milliseconds(time.ns / 1'000'000) - chrono::seconds(offset.gps_minus_utc_s);
  const auto day_begin = chrono::floor<chrono::days>(utc);
  const chrono::year_month_day date{day_begin};
  const chrono::hh_mm_ss clock{chrono::floor<milliseconds>(utc - day_begin)};
  return {static_cast<int>(date.year()),
          static_cast<unsigned>(date.month()),
          static_cast<unsigned>(date.day()),
          static_cast<unsigned>(clock.hours().count()),
          static_cast<unsigned>(clock.minutes().count()),
          static_cast<unsigned>((clock.seconds() + clock.subseconds()).count())};
}

}  // namespace vbar::twins::gnss
