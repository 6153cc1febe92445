#include "host_sim/truth/earth/weather_formats/weather_formats.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/truth/earth/day_sequence.h"

namespace vbar::truth {
namespace {

using Day = SpaceWeather::Day;

// Below the flux of a Sun without spots (65).
constexpr double kLowestFlux = 50.0;

double checked(const files::TextLines& lines, double value, double low, double high, std::string_view what) {
  if (!(value >= low && value <= high))
    lines.refuse(fmt::format("{} of {}", what, value), fmt::format("{} to {}", low, high));
  return value;
}

double flux_of(const files::TextLines& lines, double value) {
  return checked(lines, value, kLowestFlux, kLargestFlux, "a flux F10.7 (1e-22 W/m^2/Hz)");
}

/// Whether a flux was measured: 0 marks a day without a measurement in files of before 2020.
bool is_measured(const std::optional<double>& flux) {
  return flux && *flux != 0.0;
}

bool is_complete(const PublishedWeather& row) {
  const auto has_value = [](const std::optional<double>& value) { return value.has_value(); };
  return std::ranges::all_of(row.ap, has_value) && row.ap_daily && is_measured(row.f107_observed) &&
         is_measured(row.f107_observed_81d);
}

Day without_data(int mjd, int line) {
  Day day;
  day.mjd_utc = mjd;
  day.line = line;
  day.kind = SpaceWeather::Kind::kMissing;
  return day;
}

Day between(const Day& a, const Day& b, int mjd) {
  const double t = static_cast<double>(mjd - a.mjd_utc) / (b.mjd_utc - a.mjd_utc);
  Day day = b;
  day.mjd_utc = mjd;
  day.f107 = a.f107 + t * (b.f107 - a.f107);
  day.f107_average = a.f107_average + t * (b.f107_average - a.f107_average);
  return day;
}

}  // namespace

std::span<const WeatherFormat> weather_formats() {
  static constexpr std::array kFormats{
      WeatherFormat{"CSSI space weather (SW-All.txt)", is_cssi_text, read_cssi_text},
      WeatherFormat{"CSSI space weather (SW-All.csv)", is_cssi_csv, read_cssi_csv},
      WeatherFormat{"the table of data/earth", is_weather_table, read_weather_table},
  };
  return kFormats;
}

WeatherDays read_weather(std::string_view text, const std::string& file) {
  const auto formats = weather_formats();
  const auto format = std::ranges::find_if(formats, [&](const auto& one) { return one.recognises(text); });
  if (format != formats.end()) return format->read(text, file);
  files::TextLines lines(text, file);
  lines.next();
  std::vector<std::string_view> names;
  for (const WeatherFormat& one : formats) names.push_back(one.name);
  lines.refuse(fmt::format("space weather in one of the formats {}", fmt::join(names, ", ")));
}

void WeatherCollector::append(const Day& day) {
  if (day.mjd_utc >= kFirstDataMjd) days_.push_back(day);
  last_ = day;
  has_any_ = true;
}

void WeatherCollector::add_day(const files::TextLines& lines, const PublishedWeather& row, SpaceWeather::Kind kind) {
  if (has_any_ && row.mjd_utc != last_.mjd_utc + 1) {
    throw files::FormatError(fmt::format("{}:{}: day {} follows day {}; days must follow without gaps", lines.file(),
                                         lines.number(), row.mjd_utc, last_.mjd_utc));
  }
  if (!is_complete(row)) {
    append(without_data(row.mjd_utc, lines.number()));
    return;
  }
  Day day;
  day.mjd_utc = row.mjd_utc;
  day.line = lines.number();
  day.kind = kind;
  for (std::size_t k = 0; k < row.ap.size(); ++k) day.ap[k] = checked(lines, *row.ap[k], 0.0, kLargestAp, "an ap");
  day.ap_daily = checked(lines, *row.ap_daily, 0.0, kLargestAp, "an Ap");
  day.f107 = flux_of(lines, *row.f107_observed);
  day.f107_average = flux_of(lines, *row.f107_observed_81d);
  append(day);
}

void WeatherCollector::add_month(const files::TextLines& lines, const PublishedWeather& row) {
  constexpr int kLongestGap_days = 62;  // from the last daily prediction through a whole month
  if (!is_measured(row.f107_observed)) return;
  Day day;
  day.mjd_utc = row.mjd_utc;
  day.line = lines.number();
  day.kind = SpaceWeather::Kind::kPredictedMonthly;
  day.ap.fill(SpaceWeather::kAssumedAp);
  day.ap_daily = SpaceWeather::kAssumedAp;
  day.f107 = flux_of(lines, *row.f107_observed);
  day.f107_average = is_measured(row.f107_observed_81d) ? flux_of(lines, *row.f107_observed_81d) : day.f107;
  if (has_any_) {
    const Day before = last_;
    if (day.mjd_utc <= before.mjd_utc) return;
    if (day.mjd_utc > before.mjd_utc + kLongestGap_days)
      lines.refuse(fmt::format("a month {} days behind the row before", day.mjd_utc - before.mjd_utc),
                   fmt::format("a row at most {} days before", kLongestGap_days));
    const bool has_data = before.kind != SpaceWeather::Kind::kMissing;
    for (int mjd = before.mjd_utc + 1; mjd < day.mjd_utc; ++mjd)
      append(has_data ? between(before, day, mjd) : without_data(mjd, lines.number()));
  }
  append(day);
}

}  // namespace vbar::truth
