// FORMAT(I4,I3,I3,I5,I3,8I3,I4,8I4,I4,F4.1,I2,I4,F6.1,I2,5F6.1): CelesTrak, "Space Weather Data Documentation".

#include <array>

#include "host_sim/truth/earth/day_sequence.h"
#include "host_sim/truth/earth/sections.h"
#include "host_sim/truth/earth/weather_formats/weather_formats.h"

namespace vbar::truth {
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

}  // namespace vbar::truth
