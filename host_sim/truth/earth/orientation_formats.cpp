#include "host_sim/truth/earth/orientation_formats.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>

#include <erfam.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/files/text_lines.h"
#include "host_sim/truth/earth/published_tables.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::truth {

namespace {

constexpr std::string_view kColumns = "mjd_utc,x_arcsec,y_arcsec,ut1_minus_utc_s,dx_arcsec,dy_arcsec";

}  // namespace

bool is_orientation_table(std::string_view text) {
  return is_daily_table(text);
}

OrientationDays read_orientation_table(std::string_view text, const std::string& file) {
  OrientationDays days;
  read_daily_table<6>(
      text, file, kColumns, [&](const files::TextLines& lines, int mjd_utc, const std::array<double, 6>& row) {
        days.push_back({mjd_utc, orientation_of(lines, mjd_utc, {row[1], row[2], row[3], row[4], row[5]})});
      });
  return days;
}

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

namespace {

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

// CSV of the IERS data centre (finals2000A, EOP C04: one set of column names) and of CelesTrak (EOP-All.csv).

namespace {

/// Whether a value is predicted, by its type. Series C04 has no types.
bool is_prediction(const TextLines& lines, std::string_view type) {
  if (type == "prediction") return true;
  if (!type.empty() && type != "final")
    lines.refuse(fmt::format("the type {}", files::quoted(type)), "final, prediction or nothing");
  return false;
}

void check_mjd(const TextLines& lines, double mjd, int date) {
  if (mjd != date)
    lines.refuse(fmt::format("the MJD {}", mjd), fmt::format("{}, that of the row's date at 0h UTC", date));
}

class IersCsv {
 public:
  IersCsv(std::string_view text, const std::string& file) : lines_(text, file), table_(lines_, ';') {}

  OrientationDays read() {
    DaySequence sequence;
    bool has_ended = false;
    while (table_.next()) {
      const int date = mjd_of_date(lines_, table_.integer(year_), table_.integer(month_), table_.integer(day_));
      check_mjd(lines_, table_.number(mjd_), date);
      sequence.take(lines_, date);
      const bool has_values = !table_.text(x_).empty();
      if (has_values && has_ended) lines_.refuse("values behind a row without any", "rows with a date only to the end");
      has_ended = !has_values;
      if (has_values && date >= kFirstDataMjd) take_day(date);
    }
    return std::move(days_);
  }

 private:
  void take_day(int date) {
    PublishedOrientation row{table_.number(x_), table_.number(y_), table_.number(ut1_)};
    // Bulletin A, whose values have types, gives the offsets in mas, series C04 in arcsec.
    const double unit_arcsec = table_.text(pole_type_).empty() ? 1.0 : 1e-3;
    const auto dx = table_.number_or_blank(dx_), dy = table_.number_or_blank(dy_);
    if (!dx && !table_.text(dpsi_).empty())
      lines_.refuse("offsets dPsi and dEpsilon (IAU 1980)", "dX and dY (IAU 2000A), as finals2000A and C04 have them");
    row.dx_arcsec = unit_arcsec * dx.value_or(0.0);
    row.dy_arcsec = unit_arcsec * dy.value_or(0.0);
    const bool pole_is_predicted = is_prediction(lines_, table_.text(pole_type_));
    const bool ut1_is_predicted = is_prediction(lines_, table_.text(ut1_type_));
    days_.push_back({date, orientation_of(lines_, date, row), pole_is_predicted || ut1_is_predicted});
  }

  TextLines lines_;
  PublishedCsv table_;
  std::size_t mjd_ = table_.place("MJD"), year_ = table_.place("Year"), month_ = table_.place("Month"),
              day_ = table_.place("Day"), x_ = table_.place("x_pole"), y_ = table_.place("y_pole"),
              ut1_ = table_.place("UT1-UTC"), dpsi_ = table_.place("dPsi"), dx_ = table_.place("dX"),
              dy_ = table_.place("dY"), pole_type_ = table_.place_before(x_, "Type"),
              ut1_type_ = table_.place_before(ut1_, "Type");
  OrientationDays days_;
};

/// CelesTrak's flag of a row: observed or predicted.
bool is_predicted_row(const TextLines& lines, std::string_view type) {
  if (type != "O" && type != "P") lines.refuse(files::quoted(type), "a DATA_TYPE of O or P");
  return type == "P";
}

}  // namespace

bool is_iers_csv(std::string_view text) {
  return text.starts_with("MJD;Year;Month;Day;");
}

OrientationDays read_iers_csv(std::string_view text, const std::string& file) {
  return IersCsv(text, file).read();
}

bool is_celestrak_eop_csv(std::string_view text) {
  return text.starts_with("DATE,MJD,X,Y,");
}

OrientationDays read_celestrak_eop_csv(std::string_view text, const std::string& file) {
  TextLines lines(text, file);
  PublishedCsv table(lines, ',');
  const std::size_t date_at = table.place("DATE"), mjd_at = table.place("MJD"), x = table.place("X"),
                    y = table.place("Y"), ut1 = table.place("UT1-UTC"), dx = table.place("DX"), dy = table.place("DY"),
                    type = table.place("DATA_TYPE");
  OrientationDays days;
  DaySequence sequence;
  while (table.next()) {
    const int date = table.mjd_of_date(date_at);
    check_mjd(lines, table.number(mjd_at), date);
    sequence.take(lines, date);
    if (date < kFirstDataMjd) continue;
    const PublishedOrientation row{table.number(x), table.number(y), table.number(ut1),
                                   table.number_or_blank(dx).value_or(0.0), table.number_or_blank(dy).value_or(0.0)};
    days.push_back({date, orientation_of(lines, date, row), is_predicted_row(lines, table.text(type))});
  }
  return days;
}

// FORMAT(I4,I3,I3,I6,2F10.6,2F11.7,4F10.6,I4): CelesTrak, "Earth Orientation Parameters Data Documentation".

namespace {

constexpr std::array<std::string_view, 2> kSections{"OBSERVED", "PREDICTED"};

}  // namespace

bool is_celestrak_eop_text(std::string_view text) {
  constexpr std::size_t kLongestHeading = 10000;
  return !text.starts_with("DATATYPE ") &&
         text.substr(0, kLongestHeading).find("\nBEGIN OBSERVED") != std::string_view::npos;
}

OrientationDays read_celestrak_eop_text(std::string_view text, const std::string& file) {
  files::TextLines lines(text, file);
  OrientationDays days;
  DaySequence sequence;
  Sections sections(kSections);
  while (lines.next()) {
    if (lines.is_blank() || lines.line().starts_with('#') || sections.take(lines) || !sections.open()) continue;
    const int date = mjd_of_date(lines, lines.integer_in(1, 4, "a year"), lines.integer_in(5, 7, "a month"),
                                 lines.integer_in(8, 10, "a day"));
    if (const int mjd = lines.integer_in(11, 16, "the MJD"); mjd != date)
      lines.refuse(fmt::format("the MJD {}", mjd), fmt::format("{}, that of the row's date", date));
    sequence.take(lines, date);
    if (date < kFirstDataMjd) continue;
    const PublishedOrientation row{
        lines.number_in(17, 26, "the pole's x in arcsec"), lines.number_in(27, 36, "the pole's y in arcsec"),
        lines.number_in(37, 47, "UT1-UTC in s"), lines.number_or_blank_in(79, 88, "dX in arcsec").value_or(0.0),
        lines.number_or_blank_in(89, 98, "dY in arcsec").value_or(0.0)};
    days.push_back({date, orientation_of(lines, date, row), kSections[*sections.open()] == "PREDICTED"});
  }
  sections.check_end(lines);
  return days;
}

std::span<const OrientationFormat> orientation_formats() {
  static constexpr std::array kFormats{
      OrientationFormat{"IERS finals2000A", is_finals2000a, read_finals2000a},
      OrientationFormat{"CelesTrak EOP-All (text)", is_celestrak_eop_text, read_celestrak_eop_text},  // names C04 too
      OrientationFormat{"IERS EOP C04 (series 14 or 20)", is_eop_c04, read_eop_c04},
      OrientationFormat{"IERS finals2000A or C04 as CSV", is_iers_csv, read_iers_csv},
      OrientationFormat{"CelesTrak EOP-All (CSV)", is_celestrak_eop_csv, read_celestrak_eop_csv},
      OrientationFormat{"the table of data/earth", is_orientation_table, read_orientation_table},
  };
  return kFormats;
}

OrientationDays read_orientation(std::string_view text, const std::string& file) {
  const auto formats = orientation_formats();
  const auto format = std::ranges::find_if(formats, [&](const auto& one) { return one.recognises(text); });
  if (format != formats.end()) return format->read(text, file);
  files::TextLines lines(text, file);
  lines.next();
  std::vector<std::string_view> names;
  for (const OrientationFormat& one : formats) names.push_back(one.name);
  lines.refuse(fmt::format("Earth orientation in one of the formats {}", fmt::join(names, ", ")));
}

EarthOrientation orientation_of(const files::TextLines& lines, int mjd_utc, const PublishedOrientation& row) {
  // Since 1962: the pole within 0.6 arcsec, UT1-UTC within 0.9 s by definition, IAU 2000A nutation within 1.5 mas
  // (that of IAU 1980 is off by 50 to 150 mas).
  constexpr double kPole_arcsec = 1.0, kUt1_s = 1.0, kOffset_arcsec = 0.01;
  const auto check = [&](double value, double limit, std::string_view what, std::string_view unit) {
    if (!(std::abs(value) <= limit))
      lines.refuse(fmt::format("{} of {} {}", what, value, unit), fmt::format("up to {} {}", limit, unit));
  };
  check(row.x_arcsec, kPole_arcsec, "a pole x", "arcsec");
  check(row.y_arcsec, kPole_arcsec, "a pole y", "arcsec");
  check(row.ut1_minus_utc_s, kUt1_s, "a UT1-UTC", "s");
  check(row.dx_arcsec, kOffset_arcsec, "a dX (IAU 2000A)", "arcsec");
  check(row.dy_arcsec, kOffset_arcsec, "a dY (IAU 2000A)", "arcsec");
  return {row.ut1_minus_utc_s - tai_minus_utc_s(mjd_utc), row.x_arcsec * ERFA_DAS2R, row.y_arcsec * ERFA_DAS2R,
          row.dx_arcsec * ERFA_DAS2R, row.dy_arcsec * ERFA_DAS2R};
}

}  // namespace vbar::truth
