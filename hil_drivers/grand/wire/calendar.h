#pragma once
// Calendar dates on the scale of GPS time, as generators take their start time: no leap seconds.

#include <string>

#include "fsw/core/gps_time.h"

namespace vbar::grand::wire {

struct Calendar {
  int year = 1980;
  unsigned month = 1, day = 6, hour = 0, minute = 0, second = 0;
  friend bool operator==(const Calendar&, const Calendar&) = default;
};

/// Returns the date of the whole second that contains `time`.
Calendar calendar_of(fsw::GpsTime time);

/// Returns the time of a date. Throws WireError for a date that does not exist or lies outside 1980-01-06 to 2200.
fsw::GpsTime time_of(const Calendar& calendar);

/// Returns "2011-07-19 16:00:00".
std::string text_of(const Calendar& calendar);

}  // namespace vbar::grand::wire
