// CSV of the IERS data centre (finals2000A, EOP C04: one set of column names) and of CelesTrak (EOP-All.csv).

#include <fmt/format.h>

#include "host_sim/files/text_lines.h"
#include "host_sim/truth/earth/day_sequence.h"
#include "host_sim/truth/earth/orientation_formats/orientation_formats.h"
#include "host_sim/truth/earth/published_csv.h"

namespace vbar::truth {
namespace {

using files::TextLines;

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

}  // namespace vbar::truth
