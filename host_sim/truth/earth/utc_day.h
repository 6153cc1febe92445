#pragma once
// Days of UTC on the project's clock. A day is 86400 s, or 86401 s with a leap second.

#include "fsw/core/gps_time.h"

namespace vbar::truth {

/// Returns 0h UTC of a modified Julian day. Throws std::out_of_range before UTC's leap seconds (1972).
fsw::GpsTime midnight_utc(int mjd_utc);

/// Returns the modified Julian day that an instant lies in. Throws std::out_of_range before 1980-01-06.
int mjd_utc_of(fsw::GpsTime time);

/// Returns the day of the year, 1 on 1 January.
int day_of_year(int mjd_utc);

}  // namespace vbar::truth
