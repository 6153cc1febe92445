#pragma once
// Conversion between the clock of the project (integer nanoseconds of GPS time) and other time scales.
// GPS = TAI - 19 s exactly; TT = TAI + 32.184 s exactly; UTC by the leap-second table of ERFA; UT1 needs Earth
// orientation data (earth_orientation.h). Julian dates are ERFA's two-part form, so that a nanosecond survives.

#include <string>
#include <string_view>

#include "fsw/core/gps_time.h"

namespace vbar::truth {

inline constexpr double kSecondsPerDay = 86400.0;

/// A Julian date in two parts, days, in the time scale that the variable's name states; their sum is the date.
/// `day` is the large part (a multiple of 0.5), `fraction` the remainder.
struct JulianDate {
  double day = 0.0;
  double fraction = 0.0;
};

/// Returns TAI and TT of an instant `seconds` (s, may be fractional or negative) after `epoch`. Error under 1e-11 s
/// while |seconds| < 1e5, under 2e-9 s within a year.
JulianDate tai_of(fsw::GpsTime epoch, double seconds = 0.0);
JulianDate tt_of(fsw::GpsTime epoch, double seconds = 0.0);

/// Returns UTC of an instant as ERFA's quasi Julian date (a day with a leap second is 86401 s long). Throws
/// std::out_of_range before 1980-01-06.
JulianDate utc_of(fsw::GpsTime time);

/// Returns UT1 from TAI and UT1-TAI (s).
JulianDate ut1_of(JulianDate tai, double ut1_minus_tai_s);

/// Returns TAI-UTC, s, at 0h UTC of a modified Julian day. Throws std::out_of_range before UTC's leap seconds (1972).
double tai_minus_utc_s(int mjd_utc);

/// Returns the first modified Julian day with this day's TAI-UTC: that of a leap second, or of 1972-01-01. Throws
/// std::out_of_range before UTC's leap seconds (1972).
int first_day_of_tai_minus_utc(int mjd_utc);

/// Returns the instant of an ISO 8601 UTC text: YYYY-MM-DDThh:mm:ss[.fraction][Z], a blank for the T allowed, at most
/// nine decimals, second 60 only where there was a leap second. Throws std::invalid_argument, which quotes the text and
/// states what is accepted.
fsw::GpsTime gps_from_utc(std::string_view iso8601);

/// Returns UTC text, e.g. "2011-07-18T01:00:00.000Z", rounded to `decimals` (0 to 9) digits of the second. Throws
/// std::out_of_range before 1980-01-06, std::invalid_argument for another number of digits.
std::string format_utc(fsw::GpsTime time, int decimals = 3);

// Days of UTC on the project's clock. A day is 86400 s, or 86401 s with a leap second.

/// Returns 0h UTC of a modified Julian day. Throws std::out_of_range before UTC's leap seconds (1972).
fsw::GpsTime midnight_utc(int mjd_utc);

/// Returns the modified Julian day that an instant lies in. Throws std::out_of_range before 1980-01-06.
int mjd_utc_of(fsw::GpsTime time);

/// Returns the day of the year, 1 on 1 January.
int day_of_year(int mjd_utc);

}  // namespace vbar::truth
