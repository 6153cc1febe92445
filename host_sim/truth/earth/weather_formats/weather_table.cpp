#include <algorithm>
#include <array>

#include "host_sim/truth/earth/daily_table.h"
#include "host_sim/truth/earth/weather_formats/weather_formats.h"

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

}  // namespace vbar::truth
