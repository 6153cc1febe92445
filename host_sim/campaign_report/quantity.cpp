#include "host_sim/campaign_report/quantity.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "host_sim/report/csv_table.h"
#include "host_sim/report/plots/number_text.h"
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

std::vector<SweepPoint> sweep_points(const Campaign& campaign) {
  std::vector<std::size_t> swept;
  for (const std::string& key : campaign.swept)
    swept.push_back(static_cast<std::size_t>(std::ranges::find(campaign.keys, key) - campaign.keys.begin()));
  std::vector<SweepPoint> points;
  std::map<std::string, std::size_t> known;
  for (std::size_t place = 0; place < campaign.cases.size(); ++place) {
    std::string name;
    for (const std::size_t key : swept)
      name += fmt::format("{}{} = {}", name.empty() ? "" : ", ", campaign.keys[key], campaign.cases[place].inputs[key]);
    const auto [found, is_new] = known.emplace(name, points.size());
    if (is_new) points.push_back({name, {}});
    points[found->second].places.push_back(place);
  }
  return points;
}

bool share_seeds(const Campaign& campaign) {
  if (campaign.swept.empty()) return false;
  std::set<std::string_view> seeds;
  return !std::ranges::all_of(campaign.cases, [&](const Case& one) { return seeds.insert(one.seed).second; });
}

namespace {

constexpr double kSameTime_h = 1e-6;

/// The time of "samples.<time>h.<rest>", and the rest.
std::optional<std::pair<double, std::string_view>> sample_of(std::string_view key) {
  constexpr std::string_view kPrefix = "samples.", kUnit = "h.";
  if (!key.starts_with(kPrefix)) return std::nullopt;
  double time_h = 0.0;
  const char* const end = key.data() + key.size();
  const auto [after, error] = std::from_chars(key.data() + kPrefix.size(), end, time_h);
  const std::string_view rest(after, static_cast<std::size_t>(end - after));
  if (error != std::errc{} || !rest.starts_with(kUnit)) return std::nullopt;
  return std::pair{time_h, rest.substr(kUnit.size())};
}

std::vector<NormalisedError> errors_of(const Campaign& campaign, const Figure& values, const Figure& dimensions,
                                       const std::vector<std::size_t>& places) {
  std::vector<NormalisedError> errors;
  for (const std::size_t place : places) {
    const double value = values.values[place], dimension = dimensions.values[place];
    if (!campaign.cases[place].is_complete() || std::isnan(value)) continue;
    if (value == 0.0 && dimension == 0.0) continue;  // nothing was measured
    if (!(value >= 0.0) || !(dimension > 0.0))
      throw std::runtime_error(
          fmt::format("results.csv: case {}: \"{}\" is {} with \"{}\" {}; neither can be negative, "
                      "and one requires the other",
                      campaign.cases[place].number, values.key, value, dimensions.key,
                      std::isnan(dimension) ? "missing" : fmt::format("{}", dimension)));
    errors.push_back({value, dimension});
  }
  return errors;
}

}  // namespace

std::vector<Epoch> epochs_of(const Campaign& campaign, std::string_view name, const std::vector<std::size_t>& places) {
  std::vector<Epoch> epochs;
  for (const Figure& values : campaign.figures) {
    const auto sample = sample_of(values.key);
    if (!sample || sample->second != name) continue;
    const Figure* const dimensions = campaign.figure(values.key + "_dimension");
    if (dimensions == nullptr)
      throw std::runtime_error(fmt::format("results.csv: no column \"{}_dimension\"", values.key));
    const std::vector<NormalisedError> errors = errors_of(campaign, values, *dimensions, places);
    if (!errors.empty()) epochs.push_back(epoch_of(sample->first, errors));
  }
  std::ranges::sort(epochs, {}, &Epoch::time_h);
  return epochs;
}

std::vector<double> missing_samples(const Campaign& campaign) {
  std::vector<double> missing;
  if (std::ranges::none_of(campaign.cases, &Case::is_complete)) return missing;
  std::ranges::copy_if(campaign.samples_h, std::back_inserter(missing), [&](double time_h) {
    return std::ranges::none_of(campaign.figures, [&](const Figure& figure) {
      const auto sample = sample_of(figure.key);
      return sample && std::abs(sample->first - time_h) < kSameTime_h;
    });
  });
  return missing;
}

namespace {

std::string_view without_spaces(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  return first == std::string_view::npos ? "" : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::optional<double> number_of(std::string_view text) {
  text = without_spaces(text);
  if (text == "true" || text == "false") return text == "true" ? 1.0 : 0.0;
  double value = 0.0;
  return !text.empty() && report::read_value(text, value) ? std::optional(value) : std::nullopt;
}

/// The numbers of "0.5" or "[1.0, 2.0, 3.0]"; none if one is not a number.
std::vector<double> numbers_of(std::string_view text) {
  text = without_spaces(text);
  if (text.starts_with('[') && text.ends_with(']')) text = text.substr(1, text.size() - 2);
  std::vector<double> numbers;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    const std::optional<double> number = number_of(text.substr(start, end - start));
    if (!number) return {};
    numbers.push_back(*number);
    start = end + 1;
  }
  return numbers;
}

bool is_constant(const std::vector<double>& values) {
  return std::ranges::all_of(values, [&](double v) { return v == values.front(); });
}

}  // namespace

std::vector<Driver> drivers(const Campaign& campaign, std::vector<std::string>& others) {
  std::vector<Driver> all;
  for (std::size_t key = 0; key < campaign.keys.size(); ++key) {
    std::vector<std::vector<double>> components;
    for (const Case& one : campaign.cases) {
      const std::vector<double> numbers = numbers_of(one.inputs[key]);
      if (components.empty()) components.resize(numbers.size());
      if (numbers.empty() || numbers.size() != components.size()) {
        components.clear();
        break;
      }
      for (std::size_t k = 0; k < numbers.size(); ++k) components[k].push_back(numbers[k]);
    }
    const std::size_t before = all.size();
    for (std::size_t k = 0; k < components.size(); ++k) {
      if (is_constant(components[k])) continue;
      all.push_back({components.size() == 1 ? campaign.keys[key] : fmt::format("{}[{}]", campaign.keys[key], k),
                     std::move(components[k])});
    }
    if (all.size() == before) others.push_back(campaign.keys[key]);
  }
  return all;
}

std::vector<Response> responses(const Campaign& campaign, const std::vector<Quantity>& quantities) {
  std::vector<Response> all;
  for (const Quantity& quantity : quantities) all.push_back({quantity.key, quantity.values, &quantity});
  Response failure{"not passed", {}, nullptr};
  for (const Case& one : campaign.cases)
    failure.values.push_back(!one.is_judged()   ? std::numeric_limits<double>::quiet_NaN()
                             : one.has_passed() ? 0.0
                                                : 1.0);
  all.push_back(std::move(failure));
  return all;
}

std::vector<Dependence> dependences(const std::vector<Driver>& drivers, const std::vector<Response>& responses) {
  std::vector<Dependence> all;
  std::vector<double> p_values;
  for (const Driver& driver : drivers) {
    for (const Response& response : responses) {
      const auto correlation = spearman(driver.values, response.values);
      if (!correlation) continue;
      all.push_back({&driver, &response, *correlation, 1.0});
      p_values.push_back(correlation->p_value);
    }
  }
  const std::vector<double> adjusted = holm(p_values);
  for (std::size_t k = 0; k < all.size(); ++k) all[k].adjusted_p = adjusted[k];
  std::ranges::stable_sort(all, std::greater{}, [](const Dependence& d) { return std::abs(d.correlation.rho); });
  return all;
}

}  // namespace vbar::campaign_report
