// FORMAT(I4,I3,I3,I5,I3,8I3,I4,8I4,I4,F4.1,I2,I4,F6.1,I2,5F6.1): CelesTrak, "Space Weather Data Documentation".

#include <array>
#include <utility>

#include <fmt/format.h>

#include "host_sim/truth/earth/day_sequence.h"
#include "host_sim/truth/earth/weather_formats/weather_formats.h"

namespace vbar::truth {
namespace {

using files::TextLines;
using Kind = SpaceWeather::Kind;

constexpr std::array<std::pair<std::string_view, Kind>, 3> kSections{{{"OBSERVED", Kind::kObserved},
                                                                      {"DAILY_PREDICTED", Kind::kPredictedDaily},
                                                                      {"MONTHLY_PREDICTED", Kind::kPredictedMonthly}}};

int whole(const TextLines& lines, std::size_t first, std::size_t last, std::string_view what) {
  const auto value = files::integer_of(lines.columns(first, last));
  if (!value) lines.refuse(fmt::format("{} in columns {} to {}", what, first, last));
  return *value;
}

std::optional<double> value_in(const TextLines& lines, std::size_t first, std::size_t last, std::string_view what) {
  if (files::trimmed(lines.columns(first, last)).empty()) return std::nullopt;
  const auto value = files::number_of(lines.columns(first, last));
  if (!value) lines.refuse(fmt::format("{} in columns {} to {}", what, first, last));
  return value;
}

PublishedWeather row_of(const TextLines& lines) {
  PublishedWeather row;
  row.mjd_utc =
      mjd_of_date(lines, whole(lines, 1, 4, "a year"), whole(lines, 5, 7, "a month"), whole(lines, 8, 10, "a day"));
  constexpr std::size_t kFirstAp = 47, kWidth = 4;
  for (std::size_t k = 0; k < row.ap.size(); ++k)
    row.ap[k] = value_in(lines, kFirstAp + kWidth * k, kFirstAp + kWidth * k + kWidth - 1, "an ap");
  row.ap_daily = value_in(lines, 79, 82, "the Ap of the day");
  row.f107_observed = value_in(lines, 113, 118, "the observed F10.7");
  row.f107_observed_81d = value_in(lines, 119, 124, "the observed F10.7 of 81 days");
  return row;
}

/// The sections of the file, of which at most one is open.
class Sections {
 public:
  /// Whether the line begins or ends one.
  bool take(const TextLines& lines) {
    const std::string_view line = files::trimmed(lines.line());
    if (!line.starts_with("BEGIN ") && !line.starts_with("END ")) return false;
    const std::string_view name = line.substr(line.find(' ') + 1);
    const bool begins = line.starts_with("BEGIN ");
    for (const auto& [section, kind] : kSections) {
      if (name != section) continue;
      if (begins == open_.has_value() || (!begins && *open_ != kind))
        lines.refuse("BEGIN and END of one section after the other");
      open_ = begins ? std::optional(kind) : std::nullopt;
      return true;
    }
    lines.refuse("BEGIN or END of OBSERVED, DAILY_PREDICTED or MONTHLY_PREDICTED");
  }

  [[nodiscard]] std::optional<Kind> open() const { return open_; }

 private:
  std::optional<Kind> open_;
};

}  // namespace

bool is_cssi_text(std::string_view text) {
  return text.starts_with("DATATYPE CssiSpaceWeather") || text.substr(0, 10000).find("BEGIN OBSERVED") != text.npos;
}

WeatherDays read_cssi_text(std::string_view text, const std::string& file) {
  TextLines lines(text, file);
  WeatherCollector days;
  Sections sections;
  while (lines.next()) {
    if (lines.is_blank() || lines.line().starts_with('#') || sections.take(lines)) continue;
    const std::optional<Kind> kind = sections.open();
    if (!kind) continue;  // headings
    if (*kind == Kind::kPredictedMonthly)
      days.add_month(lines, row_of(lines));
    else
      days.add_day(lines, row_of(lines), *kind);
  }
  if (sections.open()) lines.refuse("the end of the file", "the END of the section");
  return days.take();
}

}  // namespace vbar::truth
