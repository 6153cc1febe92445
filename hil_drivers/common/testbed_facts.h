#pragma once
// Figures of a testbed as its section of the report shows them.

#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/summary.h"

namespace vbar::testbeds {

/// Returns the text of a figure; empty: there is none of that name.
[[nodiscard]] inline std::string text_of(const report::TestbedFigures& figures, const std::string& name) {
  const auto found = figures.find(name);
  if (found == figures.end()) return "";
  const auto* const text = std::get_if<std::string>(&found->second);
  return text != nullptr ? *text : report::significant(std::get<double>(found->second), 6);
}

/// Returns all figures, their names as words.
[[nodiscard]] inline std::vector<report::Fact> facts_of(const report::TestbedFigures& figures) {
  std::vector<report::Fact> facts;
  for (const auto& [name, value] : figures) {
    std::string words = name;
    std::ranges::replace(words, '_', ' ');
    facts.push_back({words, text_of(figures, name)});
  }
  return facts;
}

}  // namespace vbar::testbeds
