#include "host_sim/campaign_report/quantity.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "host_sim/report/number_text.h"
#include "host_sim/report/statistics.h"

namespace vbar::campaign_report {
namespace {

struct UnitSuffix {
  std::string_view suffix, symbol;
  report::Unit unit = report::Unit::kNone;
};
constexpr std::array kUnits{UnitSuffix{"_mps", "m/s", report::Unit::kMetresPerSecond},
                            UnitSuffix{"_km", "km"},
                            UnitSuffix{"_mm", "mm"},
                            UnitSuffix{"_kg", "kg"},
                            UnitSuffix{"_deg", "deg"},
                            UnitSuffix{"_arcsec", "arcsec"},
                            UnitSuffix{"_m2", "m²"},
                            UnitSuffix{"_ms", "ms"},
                            UnitSuffix{"_ns", "ns"},
                            UnitSuffix{"_dbhz", "dBHz"},
                            UnitSuffix{"_db", "dB"},
                            UnitSuffix{"_hz", "Hz"},
                            UnitSuffix{"_h", "h"},
                            UnitSuffix{"_s", "s"},
                            UnitSuffix{"_m", "m", report::Unit::kMetres}};

UnitSuffix unit_of(std::string_view key) {
  const auto* const found = std::ranges::find_if(kUnits, [&](const UnitSuffix& u) { return key.ends_with(u.suffix); });
  return found == kUnits.end() ? UnitSuffix{} : *found;
}

/// The largest index of "waypoints.<index>.<name>".
std::optional<int> last_waypoint(const Campaign& campaign) {
  constexpr std::string_view kPrefix = "waypoints.";
  std::optional<int> last;
  for (const Figure& figure : campaign.figures) {
    if (!figure.key.starts_with(kPrefix)) continue;
    int index = 0;
    const char* const end = figure.key.data() + figure.key.size();
    if (std::from_chars(figure.key.data() + kPrefix.size(), end, index).ec == std::errc{})
      last = std::max(last.value_or(index), index);
  }
  return last;
}

void add(const Campaign& campaign, const Limit& limit, std::vector<Quantity>& all) {
  const Figure* const figure = campaign.figure(limit.key);
  if (figure == nullptr || std::ranges::find(all, limit.key, &Quantity::key) != all.end()) return;
  Quantity quantity{limit.key, limit.max, limit.min, figure->values};
  for (std::size_t k = 0; k < quantity.values.size(); ++k)
    if (!campaign.cases[k].is_complete()) quantity.values[k] = std::numeric_limits<double>::quiet_NaN();
  if (!sorted_values(quantity).empty()) all.push_back(std::move(quantity));
}

}  // namespace

double Quantity::badness(double value) const {
  if (!has_limit()) return value;
  const double above = max ? value - *max : -std::numeric_limits<double>::infinity();
  const double below = min ? *min - value : -std::numeric_limits<double>::infinity();
  return std::max(above, below);
}

std::vector<Quantity> quantities(const Campaign& campaign) {
  std::vector<Quantity> all;
  for (const Limit& limit : campaign.limits) add(campaign, limit, all);
  if (const std::optional<int> last = last_waypoint(campaign))
    for (const char* const name : {"navigation_error_m", "control_error_m"})
      add(campaign, {fmt::format("waypoints.{}.{}", *last, name), {}, {}}, all);
  add(campaign, {"dv_mps", {}, {}}, all);
  return all;
}

std::vector<double> sorted_values(const Quantity& quantity) {
  std::vector<double> sorted;
  std::ranges::copy_if(quantity.values, std::back_inserter(sorted), [](double v) { return std::isfinite(v); });
  std::ranges::sort(sorted);
  return sorted;
}

std::string value_text(std::string_view key, double value) {
  const UnitSuffix unit = unit_of(key);
  if (unit.unit != report::Unit::kNone) return report::measure_text(value, unit.symbol);
  const std::string number = report::significant(value, 5);
  return unit.symbol.empty() ? number : fmt::format("{} {}", number, unit.symbol);
}

std::string limits_text(const Quantity& quantity) {
  std::string text;
  if (quantity.max) text = "at most " + value_text(quantity.key, *quantity.max);
  if (quantity.min) text.append(text.empty() ? "" : ", ").append("at least " + value_text(quantity.key, *quantity.min));
  return text;
}

report::Axis axis_of(std::string_view key) {
  const UnitSuffix unit = unit_of(key);
  std::string name(key.substr(key.rfind('.') == std::string_view::npos ? 0 : key.rfind('.') + 1));
  name.resize(name.size() - unit.suffix.size());
  std::ranges::replace(name, '_', ' ');
  if (unit.unit == report::Unit::kNone && !unit.symbol.empty()) name += fmt::format(", {}", unit.symbol);
  return {.name = name, .unit = unit.unit};
}

bool is_heavy_tailed(const std::vector<double>& sorted) {
  constexpr double kTimesMedian = 20.0;
  return !sorted.empty() && sorted.front() > 0.0 && sorted.back() > kTimesMedian * report::quantile(sorted, 0.5);
}

}  // namespace vbar::campaign_report
