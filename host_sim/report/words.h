#pragma once
// Every word that terminal, tables and page print for a code, a fault, a count of the flight software or a verdict,
// with its explanation. Codes and counts are explained by the comments of fsw/packets/vbar.lcm, the response to a fault
// by fsw/faults/fault_table.h, verdicts by verdict.cpp.

#include <string>
#include <vector>

namespace vbar::report {

struct ExplainedWord {
  std::string word;      ///< "navigation_timeout"
  std::string quantity;  ///< quantity that has this value: "fault", "mode", "count", "verdict"
  std::string owner;     ///< message that defines it; empty of verdicts
  std::string meaning;   ///< and what raises it
  std::string response;  ///< response of the flight software, for faults only
  std::string turn;      ///< what a user can change, or empty
};

/// Quantity by quantity: faults first, then counts, verdicts and the other codes.
[[nodiscard]] std::vector<ExplainedWord> explained_words();

}  // namespace vbar::report
