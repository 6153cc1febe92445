#include "host_sim/truth/earth/utc_day.h"

#include <cmath>
#include <cstdint>
#include <stdexcept>

#include <erfa.h>
#include <erfam.h>
#include <fmt/format.h>

#include "host_sim/truth/earth/time_scales.h"

namespace vbar::truth {
namespace {

constexpr int kMjdOfGpsEpoch = 44244;
constexpr std::int64_t kTaiMinusGps = 19;
constexpr std::int64_t kSecondsOfDay = 86400;

}  // namespace

fsw::GpsTime midnight_utc(int mjd_utc) {
  const std::int64_t days = mjd_utc - kMjdOfGpsEpoch;
  const std::int64_t seconds = kSecondsOfDay * days + std::llround(tai_minus_utc_s(mjd_utc)) - kTaiMinusGps;
  return {seconds * fsw::kNanosecondsPerSecond};
}

int mjd_utc_of(fsw::GpsTime time) {
  if (time.ns < 0) throw std::out_of_range("a time before 1980-01-06 has no GPS time and so no UTC day here");
  // GPS time is ahead of UTC by the leap seconds since 1980: the day is that of GPS time or the one before.
  const std::int64_t days = time.ns / (kSecondsOfDay * fsw::kNanosecondsPerSecond);
  const int mjd_gps = kMjdOfGpsEpoch + static_cast<int>(days);
  return time < midnight_utc(mjd_gps) ? mjd_gps - 1 : mjd_gps;
}

int day_of_year(int mjd_utc) {
  int year = 0, month = 0, day = 0;
  double fraction = 0.0, zero = 0.0, mjd_of_first_january = 0.0;
  if (eraJd2cal(ERFA_DJM0, mjd_utc, &year, &month, &day, &fraction) != 0 ||
      eraCal2jd(year, 1, 1, &zero, &mjd_of_first_january) != 0) {
    throw std::out_of_range(fmt::format("modified Julian day {} is not a calendar date", mjd_utc));
  }
  return mjd_utc - static_cast<int>(mjd_of_first_january) + 1;
}

}  // namespace vbar::truth
