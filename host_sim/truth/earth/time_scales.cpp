#include "host_sim/truth/earth/time_scales.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <erfa.h>
#include <erfam.h>
#include <fmt/format.h>

namespace vbar::truth {

namespace {

constexpr double kGpsEpochJulianDay = 2444244.5;  // 1980-01-06
constexpr std::int64_t kTaiMinusGps_ns = 19 * fsw::kNanosecondsPerSecond;
constexpr std::int64_t kNanosecondsPerDay = 86400 * fsw::kNanosecondsPerSecond;

// A span of time as whole days (the larger part) and the remainder, so that neither loses digits to the other.
JulianDate date_after(double julian_day, std::int64_t ns, double seconds) {
  std::int64_t days = ns / kNanosecondsPerDay;
  std::int64_t rest = ns % kNanosecondsPerDay;
  if (rest < 0) {
    rest += kNanosecondsPerDay;
    --days;
  }
  return {julian_day + static_cast<double>(days), (static_cast<double>(rest) / 1e9 + seconds) / kSecondsPerDay};
}

struct LeapSeconds {
  int first_mjd = 0;  // UTC day from which on the difference holds
  double tai_minus_utc_s = 0.0;
};

constexpr int kFirstYear = 1972;  // first year of leap seconds
constexpr int kLastYear = 2200;   // GPS time in nanoseconds ends in 2272; missions reach beyond their epoch

// ERFA's table, asked once: each of its answers costs a conversion to the calendar and back. Leap seconds begin with a
// month.
std::vector<LeapSeconds> read_leap_seconds() {
  std::vector<LeapSeconds> table;
  for (int month = 12 * kFirstYear; month < 12 * (kLastYear + 1); ++month) {
    double zero = 0.0, mjd = 0.0, difference = 0.0;
    if (eraCal2jd(month / 12, month % 12 + 1, 1, &zero, &mjd) != 0 ||
        eraDat(month / 12, month % 12 + 1, 1, 0.0, &difference) < 0)
      throw std::logic_error(fmt::format("ERFA knows no leap seconds of month {} of {}", month % 12 + 1, month / 12));
    if (table.empty() || table.back().tai_minus_utc_s != difference)
      table.push_back({static_cast<int>(mjd), difference});
  }
  return table;
}

const LeapSeconds& leap_seconds_at(int mjd_utc) {
  static const std::vector<LeapSeconds> kTable = read_leap_seconds();
  const auto next = std::ranges::upper_bound(kTable, mjd_utc, {}, &LeapSeconds::first_mjd);
  if (next == kTable.begin())
    throw std::out_of_range(fmt::format("no leap seconds known at modified Julian day {}", mjd_utc));
  return *(next - 1);
}

[[noreturn]] void refuse(std::string_view text) {
  throw std::invalid_argument(
      fmt::format("\"{}\" is not a UTC time; accepted is YYYY-MM-DDThh:mm:ss with up to nine decimals and an optional "
                  "Z, from 1980-01-06 to the year 2200",
                  text));
}

// Reads fields of decimal digits at fixed places and rejects anything else.
class FieldReader {
 public:
  explicit FieldReader(std::string_view text) : text_(text), rest_(text) {}

  int digits(std::size_t count) {
    if (rest_.size() < count) refuse(text_);
    int value = 0;
    for (char c : rest_.substr(0, count)) {
      if (c < '0' || c > '9') refuse(text_);
      value = 10 * value + (c - '0');
    }
    rest_.remove_prefix(count);
    return value;
  }

  void one_of(std::string_view accepted) {
    if (rest_.empty() || accepted.find(rest_.front()) == std::string_view::npos) refuse(text_);
    rest_.remove_prefix(1);
  }

  /// Nanoseconds of an optional decimal fraction.
  int fraction_ns() {
    if (rest_.empty() || rest_.front() != '.') return 0;
    rest_.remove_prefix(1);
    int value = 0;
    int count = 0;
    while (!rest_.empty() && std::isdigit(static_cast<unsigned char>(rest_.front())) != 0) {
      if (++count > 9) refuse(text_);
      value = 10 * value + (rest_.front() - '0');
      rest_.remove_prefix(1);
    }
    if (count == 0) refuse(text_);
    for (; count < 9; ++count) value *= 10;
    return value;
  }

  void end() {
    if (!rest_.empty() && (rest_.front() == 'Z' || rest_.front() == 'z')) rest_.remove_prefix(1);
    if (!rest_.empty()) refuse(text_);
  }

 private:
  std::string_view text_;
  std::string_view rest_;
};

}  // namespace

JulianDate tai_of(fsw::GpsTime epoch, double seconds) {
  return date_after(kGpsEpochJulianDay, epoch.ns + kTaiMinusGps_ns, seconds);
}

JulianDate tt_of(fsw::GpsTime epoch, double seconds) {
  JulianDate tt = tai_of(epoch, seconds);
  tt.fraction += ERFA_TTMTAI / kSecondsPerDay;
  return tt;
}

JulianDate utc_of(fsw::GpsTime time) {
  if (time.ns < 0) throw std::out_of_range("a time before 1980-01-06 has no GPS time and so no UTC here");
  const JulianDate tai = tai_of(time);
  JulianDate utc;
  if (eraTaiutc(tai.day, tai.fraction, &utc.day, &utc.fraction) < 0) {
    throw std::out_of_range(fmt::format("no UTC for GPS time {} ns", time.ns));
  }
  return utc;
}

JulianDate ut1_of(JulianDate tai, double ut1_minus_tai_s) {
  tai.fraction += ut1_minus_tai_s / kSecondsPerDay;
  return tai;
}

double tai_minus_utc_s(int mjd_utc) {
  return leap_seconds_at(mjd_utc).tai_minus_utc_s;
}

int first_day_of_tai_minus_utc(int mjd_utc) {
  return leap_seconds_at(mjd_utc).first_mjd;
}

fsw::GpsTime gps_from_utc(std::string_view iso8601) {
  FieldReader reader(iso8601);
  const int year = reader.digits(4);
  reader.one_of("-");
  const int month = reader.digits(2);
  reader.one_of("-");
  const int day = reader.digits(2);
  reader.one_of("T ");
  const int hour = reader.digits(2);
  reader.one_of(":");
  const int minute = reader.digits(2);
  reader.one_of(":");
  const int second = reader.digits(2);
  const int fraction_ns = reader.fraction_ns();
  reader.end();

  double midnight = 0.0, mjd = 0.0, tai_minus_utc = 0.0, tai_minus_utc_next_day = 0.0;
  if (year < 1980 || year > kLastYear || hour > 23 || minute > 59 ||
      eraCal2jd(year, month, day, &midnight, &mjd) != 0 || eraDat(year, month, day, 0.0, &tai_minus_utc) < 0) {
    refuse(iso8601);
  }
  tai_minus_utc_next_day = tai_minus_utc_s(static_cast<int>(mjd) + 1);
  const bool day_ends_with_leap_second = tai_minus_utc_next_day > tai_minus_utc;
  const int last_second = (day_ends_with_leap_second && hour == 23 && minute == 59) ? 60 : 59;
  if (second > last_second) refuse(iso8601);

  const std::int64_t days = std::llround(midnight + mjd - kGpsEpochJulianDay);
  const std::int64_t seconds = 60 * (60 * hour + minute) + second + std::llround(tai_minus_utc);
  const std::int64_t ns =
      days * kNanosecondsPerDay + seconds * fsw::kNanosecondsPerSecond + fraction_ns - kTaiMinusGps_ns;
  if (ns < 0) refuse(iso8601);
  return {ns};
}

std::string format_utc(fsw::GpsTime time, int decimals) {
  if (decimals < 0 || decimals > 9) throw std::invalid_argument("UTC text has 0 to 9 decimals of the second");
  const JulianDate utc = utc_of(time);
  int year = 0, month = 0, day = 0;
  int clock[4] = {};  // hour, minute, second, fraction
  eraD2dtf("UTC", decimals, utc.day, utc.fraction, &year, &month, &day, clock);
  const std::string whole =
      fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}", year, month, day, clock[0], clock[1], clock[2]);
  return decimals == 0 ? whole + "Z" : fmt::format("{}.{:0{}}Z", whole, clock[3], decimals);
}

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
