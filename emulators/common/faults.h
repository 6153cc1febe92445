#pragma once
// Rules of an emulator's faults: a table with `name` and `kind` of each, searched by either.

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/mission/table_reader.h"

namespace vbar::emulators {

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

// Faults of an emulator that have taken effect, one line of JSON each.

/// Receives the line of a fault that has taken effect.
using Acknowledge = std::function<void(const std::string& line)>;

class FaultLog {
 public:
  /// Opens the file. Throws std::runtime_error if it cannot be made.
  explicit FaultLog(const std::filesystem::path& file);

  /// Writes the line at once, since the program may be killed, then calls `acknowledge`, if there is one.
  void write(const std::string& line, const Acknowledge& acknowledge);

 private:
  std::ofstream file_;
};

}  // namespace vbar::emulators
