#include "host_sim/campaign/summary_numbers.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "host_sim/campaign/value_text.h"
#include "host_sim/files/sha256.h"

namespace vbar::campaign {
namespace {

/// Numbers of this execution rather than of the flight: by the wall clock, or of the program and the computer.
constexpr std::array<std::string_view, 8> kLeftOut{"schema",     "seed",       "wall_s", "speed_factor",
                                                   "wall_share", "provenance", "link",   "deadlines"};
constexpr std::array<std::string_view, 2> kLeftOutOfSources{"late", "latest_s"};
constexpr std::array<std::string_view, 2> kLabels{"index", "time_h"};

bool contains(const auto& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

/// "10" of a waypoint, "39.5h" of a sample, the name of a source; empty of what nothing identifies.
std::string label_of(const Json& element) {
  if (!element.is_object()) return {};
  if (element.contains("index")) return element["index"].dump();
  if (element.contains("name") && element["name"].is_string()) return element["name"].get<std::string>();
  if (!element.contains("time_h")) return {};
  std::string hours = text_of(element["time_h"].get<double>());
  if (hours.ends_with(".0")) hours.resize(hours.size() - 2);
  return hours + "h";
}

bool is_mean_and_deviation(const Json& json) {
  return json.is_object() && json.contains("mean") && json.contains("std") && json.size() <= 3;
}

/// navigation_error_m, mean: navigation_error_mean_m.
std::string with_unit_last(const std::string& key, const std::string& statistic) {
  const std::size_t unit = key.rfind('_');
  return unit == std::string::npos ? key + "_" + statistic : key.substr(0, unit) + "_" + statistic + key.substr(unit);
}

void add(const std::string& key, const Json& value, Numbers& numbers);

void add_members(const std::string& prefix, const Json& object, Numbers& numbers) {
  for (const auto& [name, value] : object.items()) {
    if (prefix.empty() && contains(kLeftOut, name)) continue;
    if (!prefix.empty() && contains(kLabels, name)) continue;
    if (prefix.starts_with("sources.") && contains(kLeftOutOfSources, name)) continue;
    add(prefix + name, value, numbers);
  }
}

void add(const std::string& key, const Json& value, Numbers& numbers) {
  if (is_mean_and_deviation(value)) {
    for (const auto& [statistic, number] : value.items()) add(with_unit_last(key, statistic), number, numbers);
  } else if (value.is_object()) {
    add_members(key + ".", value, numbers);
  } else if (value.is_array()) {
    for (const Json& element : value)
      if (const std::string label = label_of(element); !label.empty())
        add_members(key + "." + label + ".", element, numbers);
  } else if (value.is_number()) {
    numbers.emplace_back(key, value.get<double>());
  }
}

}  // namespace

Numbers numbers_of(const Json& summary) {
  Numbers numbers;
  add_members("", summary, numbers);
  return numbers;
}

std::string waypoints_sha256(const Json& summary) {
  return files::sha256_of(summary.contains("waypoints") ? summary["waypoints"].dump() : std::string());
}

std::optional<double> find_number(const Numbers& numbers, const std::string& key) {
  const auto found = std::ranges::find(numbers, key, &Numbers::value_type::first);
  return found == numbers.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace vbar::campaign
