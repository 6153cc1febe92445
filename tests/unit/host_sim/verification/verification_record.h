#pragma once
// verification.json of rows that were never flown: made of values.

#include <cmath>
#include <string>
#include <vector>

#include "host_sim/verification/record.h"

namespace vbar::verification {

inline Json flown_row(const std::string& name, const std::vector<double>& values, std::size_t achieved) {
  Json cases = Json::array();
  for (const double value : values) cases.push_back(std::isfinite(value) ? Json(value) : Json(nullptr));
  const Json quantity{{"key", "waypoints.10.navigation_error_m"},
                      {"worse", "larger"},
                      {"n", values.size()},
                      {"missing", 0},
                      {"median", values[values.size() / 2]},
                      {"p90", values.back()},
                      {"worst", values.back()},
                      {"worst_seed", 7},
                      {"worst_command", "vbar run experiment3 --seed 7"},
                      {"values", cases}};
  const Json requirement{{"subject", "median of waypoints.10.navigation_error_m"},
                         {"key", "waypoints.10.navigation_error_m"},
                         {"limit", "at most 12.4 mm"},
                         {"value", 0.0032},
                         {"text", "3.20 mm"},
                         {"met", true},
                         {"paper", {{"cell", "table_10.sil.waypoint_10.navigation_error_m"}, {"value", 0.012384}}}};
  return {{"name", name},
          {"title", "Row " + name},
          {"seeds_asked", 100},
          {"seeds_flown", values.size()},
          {"cases_per_seed", 1},
          {"cases_flown", values.size()},
          {"core_hours", 0.5},
          {"achieved", {{"count", achieved}, {"of", values.size()}, {"confidence", 0.95}, {"lower", 0.9}}},
          {"requirements", Json::array({requirement})},
          {"quantities", Json::array({quantity})},
          {"not_achieved", Json::array()}};
}

inline Json unflown_row(const std::string& name) {
  return {{"name", name}, {"title", "Row " + name}, {"seeds_asked", 40}, {"seeds_flown", 0}, {"cases_per_seed", 1}};
}

inline Json verification_of(const std::vector<Json>& rows) {
  return {{"format", 1},          {"vbar_version", "0.3.0"},    {"commit", "0123456789ab"},
          {"date", "2026-11-27"}, {"processor", "a processor"}, {"rows", rows}};
}

}  // namespace vbar::verification
