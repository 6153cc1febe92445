#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "host_sim/files/text_lines.h"
#include "host_sim/truth/earth/day_sequence.h"
#include "host_sim/truth/earth/orientation_formats/orientation_formats.h"

namespace vbar::truth {
namespace {

using files::TextLines;

/// Places of the words of a row: both series begin with year, month and day.
struct Columns {
  std::string_view series;
  std::size_t count, mjd, x, y, ut1, dx, dy;
};
constexpr Columns kSeries14{"14", 16, 3, 4, 5, 6, 8, 9};
constexpr Columns kSeries20{"20", 21, 4, 5, 6, 7, 8, 9};  // an hour behind the date, the length of day behind dX and dY

/// Headings, comments and blank lines; a row begins with a year.
bool is_row(const TextLines& lines) {
  const std::string_view line = files::trimmed(lines.line());
  return !line.empty() && std::isdigit(static_cast<unsigned char>(line.front())) != 0;
}

std::size_t heading_place(std::string_view text, std::string_view word) {
  return text.substr(0, 4000).find(word);
}

double value(const TextLines& lines, const std::vector<std::string_view>& words, std::size_t place) {
  const auto number = files::number_of(words[place]);
  if (!number) lines.refuse(files::quoted(words[place]), fmt::format("a number as value {} of the row", place + 1));
  return *number;
}

int whole(const TextLines& lines, const std::vector<std::string_view>& words, std::size_t place) {
  const auto number = files::integer_of(words[place]);
  if (!number) lines.refuse(files::quoted(words[place]), fmt::format("an integer as value {} of the row", place + 1));
  return *number;
}

EarthOrientationSeries::Day day_of(const TextLines& lines, const std::vector<std::string_view>& words, int mjd,
                                   const Columns& at) {
  return {mjd, orientation_of(lines, mjd,
                              {value(lines, words, at.x), value(lines, words, at.y), value(lines, words, at.ut1),
                               value(lines, words, at.dx), value(lines, words, at.dy)})};
}

}  // namespace

bool is_eop_c04(std::string_view text) {
  return heading_place(text, "C04") != std::string_view::npos &&
         heading_place(text, "EARTH ORIENTATION PARAMETER") != std::string_view::npos;
}

OrientationDays read_eop_c04(std::string_view text, const std::string& file) {
  OrientationDays days;
  DaySequence sequence;
  TextLines lines(text, file);
  while (lines.next()) {
    if (!is_row(lines)) continue;
    const auto words = lines.words();
    if (words.size() != kSeries14.count && words.size() != kSeries20.count)
      lines.refuse(
          fmt::format("{} values", words.size()),
          fmt::format("the {} values of a row of series 14 or the {} of series 20", kSeries14.count, kSeries20.count));
    const Columns& at = words.size() == kSeries14.count ? kSeries14 : kSeries20;
    const int date = mjd_of_date(lines, whole(lines, words, 0), whole(lines, words, 1), whole(lines, words, 2));
    if (value(lines, words, at.mjd) != date)
      lines.refuse(fmt::format("the MJD {}", words[at.mjd]),
                   fmt::format("{}, that of the row's date at 0h UTC (not the series sampled at 12h)", date));
    sequence.take(lines, date);
    if (date >= kFirstDataMjd) days.push_back(day_of(lines, words, date, at));
  }
  return days;
}

}  // namespace vbar::truth
