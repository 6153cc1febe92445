#pragma once
// Rules of an emulator's faults: a table with `name` and `kind` of each, searched by either.

#include <string>
#include <string_view>
#include <vector>

#include "host_sim/mission/table_reader.h"

namespace vbar::bench_lines {

/// Returns the rule that the key `kind` of a table names. Throws a MissionError with the names that exist.
template <typename Rules>
const auto& read_fault_rule(const mission::TableReader& section, const Rules& rules) {
  const std::string name = section.text("kind");
  for (const auto& rule : rules)
    if (rule.name == name) return rule;
  std::vector<std::string_view> names;
  for (const auto& rule : rules) names.push_back(rule.name);
  section.refuse_value("kind", mission::listing_of(names));
}

/// Returns the rule of a kind; every kind has one.
template <typename Rules, typename Kind>
constexpr const auto& fault_rule_of(const Rules& rules, Kind kind) {
  for (const auto& rule : rules)
    if (rule.kind == kind) return rule;
  return rules.front();
}

}  // namespace vbar::bench_lines
