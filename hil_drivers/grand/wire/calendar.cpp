#include "hil_drivers/grand/wire/calendar.h"

#include <chrono>

#include <fmt/format.h>

#include "hil_drivers/grand/wire/bytes.h"

namespace vbar::grand::wire {
namespace {

namespace chrono = std::chrono;
constexpr chrono::sys_days kGpsZero{chrono::year{1980} / chrono::January / 6};

}  // namespace

Calendar calendar_of(fsw::GpsTime time) {
  const chrono::sys_time<chrono::nanoseconds> instant{kGpsZero + chrono::nanoseconds(time.ns)};
  const auto day = chrono::floor<chrono::days>(instant);
  const chrono::year_month_day date{day};
  const chrono::hh_mm_ss clock{chrono::floor<chrono::seconds>(instant - day)};
  return {static_cast<int>(date.year()),
          static_cast<unsigned>(date.month()),
          static_cast<unsigned>(date.day()),
          static_cast<unsigned>(clock.hours().count()),
          static_cast<unsigned>(clock.minutes().count()),
          static_cast<unsigned>(clock.seconds().count())};
}

fsw::GpsTime time_of(const Calendar& calendar) {
  const chrono::year_month_day date{chrono::year{calendar.year}, chrono::month{calendar.month},
                                    chrono::day{calendar.day}};
  const bool is_date = calendar.year >= 1980 && calendar.year < 2200 && date.ok() && chrono::sys_days{date} >= kGpsZero;
  if (!is_date || calendar.hour > 23 || calendar.minute > 59 || calendar.second > 59)
    throw WireError("start time " + text_of(calendar) + " is not a date from 1980-01-06 to 2200");
  const auto since_zero = chrono::sys_days{date} - kGpsZero;
  return {chrono::nanoseconds(since_zero + chrono::hours(calendar.hour) + chrono::minutes(calendar.minute) +
                              chrono::seconds(calendar.second))
              .count()};
}

std::string text_of(const Calendar& calendar) {
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}:{:02}", calendar.year, calendar.month, calendar.day, calendar.hour,
                     calendar.minute, calendar.second);
}

}  // namespace vbar::grand::wire
