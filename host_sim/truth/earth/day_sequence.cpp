#include "host_sim/truth/earth/day_sequence.h"

#include <erfa.h>
#include <fmt/format.h>

namespace vbar::truth {

void DaySequence::take(const files::TextLines& lines, int mjd_utc) {
  if (before_ != 0 && mjd_utc != before_ + 1) {
    throw files::FormatError(fmt::format("{}:{}: day {} follows day {}; days must follow without gaps", lines.file(),
                                         lines.number(), mjd_utc, before_));
  }
  before_ = mjd_utc;
}

int mjd_of_date(const files::TextLines& lines, int year, int month, int day) {
  double zero = 0.0, mjd = 0.0;
  if (year < 1900 || year > 2199 || eraCal2jd(year, month, day, &zero, &mjd) != 0) {
    lines.refuse(fmt::format("the date {}-{:02}-{:02}", year, month, day), "a calendar date from 1900 to 2199");
  }
  return static_cast<int>(mjd);
}

}  // namespace vbar::truth
