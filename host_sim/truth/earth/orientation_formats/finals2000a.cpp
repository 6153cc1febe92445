#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "host_sim/files/text_lines.h"
#include "host_sim/truth/earth/day_sequence.h"
#include "host_sim/truth/earth/orientation_formats/orientation_formats.h"

namespace vbar::truth {
namespace {

using files::TextLines;
using files::trimmed;

bool is_flag(std::string_view flag) {
  return flag == "I" || flag == "P" || flag == " ";
}

bool is_comment(const TextLines& lines) {
  return lines.is_blank() || lines.line().starts_with('#');
}

/// Two digits of a year that this file can hold: its series begins in 1973.
int four_digits(int year) {
  return year < 73 ? 2000 + year : 1900 + year;
}

int date_of(const TextLines& lines) {
  constexpr std::string_view kExpected = "a row of finals2000A: year, month, day in columns 1 to 6, MJD in 8 to 15";
  const auto year = files::integer_of(lines.columns(1, 2)), month = files::integer_of(lines.columns(3, 4)),
             day = files::integer_of(lines.columns(5, 6));
  const auto mjd = files::number_of(lines.columns(8, 15));
  if (!year || !month || !day || !mjd || *year < 0) lines.refuse(kExpected);
  const int date = mjd_of_date(lines, four_digits(*year), *month, *day);
  if (*mjd != date)
    lines.refuse(fmt::format("the MJD {}", *mjd), fmt::format("{}, the MJD of the date in the row at 0h UTC", date));
  return date;
}

/// 0 if there is none.
double offset_arcsec(const TextLines& lines, std::size_t first, std::size_t last, std::string_view what) {
  return 1e-3 * lines.number_or_blank_in(first, last, what).value_or(0.0);
}

bool flag_is_prediction(const TextLines& lines, std::size_t column) {
  const std::string_view flag = trimmed(lines.columns(column, column));
  if (flag != "I" && flag != "P")
    lines.refuse(fmt::format("the flag I (observed) or P (predicted) in column {}", column));
  return flag == "P";
}

EarthOrientationSeries::Day day_of(const TextLines& lines, int mjd) {
  PublishedOrientation row;
  row.x_arcsec = lines.number_in(19, 27, "the pole's x in arcsec");
  row.y_arcsec = lines.number_in(38, 46, "the pole's y in arcsec");
  row.ut1_minus_utc_s = lines.number_in(59, 68, "UT1-UTC in s");
  row.dx_arcsec = offset_arcsec(lines, 98, 106, "dX in mas");
  row.dy_arcsec = offset_arcsec(lines, 117, 125, "dY in mas");
  const bool pole_is_prediction = flag_is_prediction(lines, 17), ut1_is_prediction = flag_is_prediction(lines, 58);
  return {mjd, orientation_of(lines, mjd, row), pole_is_prediction || ut1_is_prediction};
}

}  // namespace

bool is_finals2000a(std::string_view text) {
  TextLines lines(text, "");
  while (lines.next()) {
    if (is_comment(lines)) continue;
    const auto mjd = files::number_of(lines.columns(8, 15));
    return lines.line().size() >= 17 && lines.line()[12] == '.' && mjd && is_flag(lines.columns(17, 17));
  }
  return false;
}

OrientationDays read_finals2000a(std::string_view text, const std::string& file) {
  OrientationDays days;
  DaySequence sequence;
  TextLines lines(text, file);
  bool has_ended = false;
  while (lines.next()) {
    if (is_comment(lines)) continue;
    const int mjd = date_of(lines);
    sequence.take(lines, mjd);
    const bool has_values = !trimmed(lines.columns(17, 185)).empty();
    if (has_values && has_ended) lines.refuse("values behind a row without any", "rows with a date only to the end");
    has_ended = !has_values;
    if (has_values && mjd >= kFirstDataMjd) days.push_back(day_of(lines, mjd));
  }
  return days;
}

}  // namespace vbar::truth
