#include "host_sim/truth/earth/weather_formats.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host_sim/truth/earth/published_tables.h"

namespace vbar::truth {

namespace {

constexpr std::size_t kColumnCount = 12;
constexpr std::string_view kColumns =
    "mjd_utc,ap1,ap2,ap3,ap4,ap5,ap6,ap7,ap8,ap_daily,f107_observed,f107_observed_81d";

constexpr std::string_view kAccepted = "ap of 0 to 400 and fluxes above 0 and up to 1000";

using Row = std::array<double, kColumnCount>;

bool in_range(const Row& row) {
  const auto is_ap = [](double ap) { return ap >= 0.0 && ap <= kLargestAp; };
  const auto is_flux = [](double flux) { return flux > 0.0 && flux <= kLargestFlux; };
  return std::all_of(row.begin() + 1, row.begin() + 10, is_ap) && is_flux(row[10]) && is_flux(row[11]);
}

SpaceWeather::Day day_of(const Row& row) {
  SpaceWeather::Day day;
  day.mjd_utc = static_cast<int>(row[0]);
  std::copy_n(row.begin() + 1, day.ap.size(), day.ap.begin());
  day.ap_daily = row[9];
  day.f107 = row[10];
  day.f107_average = row[11];
  return day;
}

}  // namespace

bool is_weather_table(std::string_view text) {
  return is_daily_table(text);
}

WeatherDays read_weather_table(std::string_view text, const std::string& file) {
  WeatherDays days;
  read_daily_table<kColumnCount>(text, file, kColumns,
                                 [&](const files::TextLines& lines, int /*mjd_utc*/, const Row& row) {
                                   if (!in_range(row)) lines.refuse(kAccepted);
                                   days.push_back(day_of(row));
                                   days.back().line = lines.number();
                                 });
  return days;
}

// FORMAT(I4,I3,I3,I5,I3,8I3,I4,8I4,I4,F4.1,I2,I4,F6.1,I2,5F6.1): CelesTrak, "Space Weather Data Documentation".

namespace {

using files::TextLines;
using Kind = SpaceWeather::Kind;

// MONTHLY_FIT is a section of the files that AGI distributed with STK, in place of the monthly predictions or behind
// them.
constexpr std::array<std::string_view, 4> kSections{"OBSERVED", "DAILY_PREDICTED", "MONTHLY_PREDICTED", "MONTHLY_FIT"};
constexpr std::array<Kind, kSections.size()> kKinds{Kind::kObserved, Kind::kPredictedDaily, Kind::kPredictedMonthly,
                                                    Kind::kPredictedMonthly};

PublishedWeather row_of(const TextLines& lines) {
  PublishedWeather row;
  row.mjd_utc = mjd_of_date(lines, lines.integer_in(1, 4, "a year"), lines.integer_in(5, 7, "a month"),
                            lines.integer_in(8, 10, "a day"));
  if (row.mjd_utc < kFirstDataMjd) return row;
  constexpr std::size_t kFirstAp = 47, kWidth = 4;
  for (std::size_t k = 0; k < row.ap.size(); ++k)
    row.ap[k] = lines.number_or_blank_in(kFirstAp + kWidth * k, kFirstAp + kWidth * k + kWidth - 1, "an ap");
  row.ap_daily = lines.number_or_blank_in(79, 82, "the Ap of the day");
  row.f107_observed = lines.number_or_blank_in(113, 118, "the observed F10.7");
  row.f107_observed_81d = lines.number_or_blank_in(119, 124, "the observed F10.7 of 81 days");
  return row;
}

}  // namespace

bool is_cssi_text(std::string_view text) {
  return text.starts_with("DATATYPE CssiSpaceWeather") || text.substr(0, 10000).find("BEGIN OBSERVED") != text.npos;
}

WeatherDays read_cssi_text(std::string_view text, const std::string& file) {
  TextLines lines(text, file);
  WeatherCollector days;
  Sections sections(kSections);
  while (lines.next()) {
    if (lines.is_blank() || lines.line().starts_with('#') || sections.take(lines)) continue;
    if (!sections.open()) continue;  // headings
    const Kind kind = kKinds[*sections.open()];
    if (kind == Kind::kPredictedMonthly)
      days.add_month(lines, row_of(lines));
    else
      days.add_day(lines, row_of(lines), kind);
  }
  sections.check_end(lines);
  return days.take();
}

namespace {

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
