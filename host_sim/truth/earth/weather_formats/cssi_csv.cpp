#include <array>

#include <fmt/format.h>

#include "host_sim/truth/earth/day_sequence.h"
#include "host_sim/truth/earth/published_csv.h"
#include "host_sim/truth/earth/weather_formats/weather_formats.h"

namespace vbar::truth {
namespace {

using files::TextLines;
using Kind = SpaceWeather::Kind;

/// Observed, and interpolated over days without a measurement of the flux; daily and monthly predictions.
Kind kind_of(const TextLines& lines, std::string_view type) {
  if (type == "OBS" || type == "INT") return Kind::kObserved;
  if (type == "PRD") return Kind::kPredictedDaily;
  if (type == "PRM") return Kind::kPredictedMonthly;
  lines.refuse(files::quoted(type), "an F10.7_DATA_TYPE of OBS, INT, PRD or PRM");
}

/// Places of the columns that are needed.
struct Columns {
  explicit Columns(const PublishedCsv& table)
      : date(table.place("DATE")),
        ap_daily(table.place("AP_AVG")),
        f107_observed(table.place("F10.7_OBS")),
        f107_observed_81d(table.place("F10.7_OBS_CENTER81")),
        type(table.place("F10.7_DATA_TYPE")) {
    for (std::size_t k = 0; k < ap.size(); ++k) ap[k] = table.place(fmt::format("AP{}", k + 1));
  }

  std::size_t date, ap_daily, f107_observed, f107_observed_81d, type;
  std::array<std::size_t, 8> ap{};
};

PublishedWeather row_of(const PublishedCsv& table, const Columns& at) {
  PublishedWeather row;
  row.mjd_utc = table.mjd_of_date(at.date);
  if (row.mjd_utc < kFirstDataMjd) return row;
  for (std::size_t k = 0; k < row.ap.size(); ++k) row.ap[k] = table.number_or_blank(at.ap[k]);
  row.ap_daily = table.number_or_blank(at.ap_daily);
  row.f107_observed = table.number_or_blank(at.f107_observed);
  row.f107_observed_81d = table.number_or_blank(at.f107_observed_81d);
  return row;
}

}  // namespace

bool is_cssi_csv(std::string_view text) {
  return text.starts_with("DATE,BSRN,");
}

WeatherDays read_cssi_csv(std::string_view text, const std::string& file) {
  TextLines lines(text, file);
  PublishedCsv table(lines, ',');
  const Columns at(table);
  WeatherCollector days;
  while (table.next()) {
    const PublishedWeather row = row_of(table, at);
    const Kind kind = kind_of(lines, table.text(at.type));
    if (kind == Kind::kPredictedMonthly)
      days.add_month(lines, row);
    else
      days.add_day(lines, row, kind);
  }
  return days.take();
}

}  // namespace vbar::truth
