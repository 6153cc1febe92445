#pragma once
// The formats of space weather that are read as published. Each is recognised by its contents, whatever the name of the
// file; each has its functions here and its line in the list.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/files/text_lines.h"
#include "host_sim/truth/earth/space_weather.h"

namespace vbar::truth {

using WeatherDays = std::vector<SpaceWeather::Day>;

// Largest ap of its scale, and the flux of the largest flare.
inline constexpr double kLargestAp = 400.0;
inline constexpr double kLargestFlux = 1000.0;

struct WeatherFormat {
  std::string_view name;
  bool (*recognises)(std::string_view text);
  /// Reads the days of a text. Throws files::FormatError. Only the date is read of days before GPS time (1980-01-06),
  /// which are left out.
  WeatherDays (*read)(std::string_view text, const std::string& file);
};

// Table of this project: "mjd_utc,ap1,...,ap8,ap_daily,f107_observed,f107_observed_81d".
[[nodiscard]] bool is_weather_table(std::string_view text);
[[nodiscard]] WeatherDays read_weather_table(std::string_view text, const std::string& file);

// SW-All.txt, SW-Last5Years.txt of CelesTrak (CSSI), SpaceWeather-All of AGI: fixed columns; sections of observed,
// daily and monthly predicted values, and of a monthly fit.
[[nodiscard]] bool is_cssi_text(std::string_view text);
[[nodiscard]] WeatherDays read_cssi_text(std::string_view text, const std::string& file);

// SW-All.csv, SW-Last5Years.csv of CelesTrak: named columns, F10.7_DATA_TYPE OBS, INT, PRD or PRM.
[[nodiscard]] bool is_cssi_csv(std::string_view text);
[[nodiscard]] WeatherDays read_cssi_csv(std::string_view text, const std::string& file);

[[nodiscard]] std::span<const WeatherFormat> weather_formats();

/// Reads the days of a text in any of the formats. Throws files::FormatError; for an unknown format it names all.
[[nodiscard]] WeatherDays read_weather(std::string_view text, const std::string& file);

/// Values that both CSSI formats hold of one row; empty where the row is blank.
struct PublishedWeather {
  int mjd_utc = 0;
  std::array<std::optional<double>, 8> ap;
  std::optional<double> ap_daily, f107_observed, f107_observed_81d;
};

/// Collects the rows of a CSSI file as days without gaps.
class WeatherCollector {
 public:
  /// Adds a day that follows the one before. If a value is missing, or a flux 0, the day is kept as one without data.
  void add_day(const files::TextLines& lines, const PublishedWeather& row, SpaceWeather::Kind kind);

  /// Adds the first day of a month, which has no geomagnetic index: the days since the row before get fluxes by linear
  /// interpolation and SpaceWeather::kAssumedAp. A month within the days that are there, or without a flux, is left
  /// out.
  void add_month(const files::TextLines& lines, const PublishedWeather& row);

  [[nodiscard]] WeatherDays take() { return std::move(days_); }

 private:
  void append(const SpaceWeather::Day& day);

  WeatherDays days_;
  SpaceWeather::Day last_;
  bool has_any_ = false;
};

}  // namespace vbar::truth
