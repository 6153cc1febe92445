#pragma once
// Days of a daily series in the order of its file.

#include "host_sim/files/text_lines.h"

namespace vbar::truth {

// Days of GPS time's century; a series of daily values has no others.
inline constexpr int kFirstDataMjd = 44244;  // 1980-01-06
inline constexpr int kLastDataMjd = 88068;   // 2099-12-31

class DaySequence {
 public:
  /// Takes the day of the current line. Throws files::FormatError if it does not follow the one before.
  void take(const files::TextLines& lines, int mjd_utc);

 private:
  int before_ = 0;
};

/// Returns the modified Julian day of a calendar date. Throws files::FormatError for a date that does not exist.
[[nodiscard]] int mjd_of_date(const files::TextLines& lines, int year, int month, int day);

}  // namespace vbar::truth
