#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "host_sim/truth/earth/day_sequence.h"
#include "host_sim/truth/earth/weather_formats/weather_formats.h"

namespace vbar::truth {
namespace {

using files::TextLines;
using Kind = SpaceWeather::Kind;
using Words = std::vector<std::string_view>;

/// Where the columns that are needed stand.
struct Columns {
  std::size_t count = 0, date = 0, ap_daily = 0, f107_observed = 0, f107_observed_81d = 0, type = 0;
  std::array<std::size_t, 8> ap{};
};

Columns columns_of(const TextLines& lines) {
  Words names = files::split_at(lines.line(), ',');
  std::ranges::transform(names, names.begin(), files::trimmed);
  const auto place = [&](std::string_view name) {
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) lines.refuse(fmt::format("a column {}", name));
    return static_cast<std::size_t>(found - names.begin());
  };
  Columns at;
  at.count = names.size();
  at.date = place("DATE");
  for (std::size_t k = 0; k < at.ap.size(); ++k) at.ap[k] = place(fmt::format("AP{}", k + 1));
  at.ap_daily = place("AP_AVG");
  at.f107_observed = place("F10.7_OBS");
  at.f107_observed_81d = place("F10.7_OBS_CENTER81");
  at.type = place("F10.7_DATA_TYPE");
  return at;
}

int date_of(const TextLines& lines, std::string_view text) {
  const Words parts = files::split_at(text, '-');
  std::array<std::optional<int>, 3> ymd;
  for (std::size_t k = 0; k < ymd.size() && parts.size() == ymd.size(); ++k) ymd[k] = files::integer_of(parts[k]);
  if (!ymd[0] || !ymd[1] || !ymd[2]) lines.refuse(files::quoted(text), "a date as 2026-11-25");
  return mjd_of_date(lines, *ymd[0], *ymd[1], *ymd[2]);
}

std::optional<double> value_of(const TextLines& lines, std::string_view text) {
  if (files::trimmed(text).empty()) return std::nullopt;
  const auto value = files::number_of(text);
  if (!value) lines.refuse(files::quoted(text), "a number or nothing");
  return value;
}

/// Observed, and interpolated over days without a measurement of the flux; daily and monthly predictions.
Kind kind_of(const TextLines& lines, std::string_view type) {
  if (type == "OBS" || type == "INT") return Kind::kObserved;
  if (type == "PRD") return Kind::kPredictedDaily;
  if (type == "PRM") return Kind::kPredictedMonthly;
  lines.refuse(files::quoted(type), "an F10.7_DATA_TYPE of OBS, INT, PRD or PRM");
}

void take_row(const TextLines& lines, const Columns& at, WeatherCollector& days) {
  const Words words = files::split_at(lines.line(), ',');
  if (words.size() != at.count)
    lines.refuse(fmt::format("{} values", words.size()), fmt::format("one for each of {} columns", at.count));
  PublishedWeather row;
  row.mjd_utc = date_of(lines, files::trimmed(words[at.date]));
  for (std::size_t k = 0; k < row.ap.size(); ++k) row.ap[k] = value_of(lines, words[at.ap[k]]);
  row.ap_daily = value_of(lines, words[at.ap_daily]);
  row.f107_observed = value_of(lines, words[at.f107_observed]);
  row.f107_observed_81d = value_of(lines, words[at.f107_observed_81d]);
  const Kind kind = kind_of(lines, files::trimmed(words[at.type]));
  if (kind == Kind::kPredictedMonthly)
    days.add_month(lines, row);
  else
    days.add_day(lines, row, kind);
}

}  // namespace

bool is_cssi_csv(std::string_view text) {
  return text.starts_with("DATE,BSRN,") || text.starts_with(
                                               "\xEF\xBB\xBF"
                                               "DATE,BSRN,");
}

WeatherDays read_cssi_csv(std::string_view text, const std::string& file) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  TextLines lines(text, file);
  WeatherCollector days;
  lines.next();
  const Columns at = columns_of(lines);
  while (lines.next())
    if (!lines.is_blank()) take_row(lines, at, days);
  return days.take();
}

}  // namespace vbar::truth
