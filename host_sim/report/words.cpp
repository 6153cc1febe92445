#include "host_sim/report/words.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <vbar/explained_codes.h>

#include "fsw/faults/fault_table.h"
#include "host_sim/report/verdict.h"

namespace vbar::report {
namespace {

constexpr std::string_view kFault = "fault";

std::string response_of(int fault) {
  const fsw::faults::Rule& rule = fsw::faults::kFaultTable[fsw::faults::place_of(fault)];
  const std::string detected =
      rule.window == 1 ? "" : fmt::format(", once {} of {} checks detect it", rule.limit, rule.window);
  switch (rule.response) {
    case fsw::faults::Response::kReport:
      return "reports it" + detected;
    case fsw::faults::Response::kIsolate:
      return "does not use what failed" + detected;
    case fsw::faults::Response::kHold:
      return "plans no burn but a retreat, in a mission with [safety]" + detected;
    case fsw::faults::Response::kRetreat:
      return "retreats, in a mission with [safety]" + detected;
  }
  return {};
}

void add_codes(bool of_faults, std::vector<ExplainedWord>& words) {
  for (const ExplainedCode& code : kExplainedCodes) {
    const bool is_fault = code.quantity == kFault;
    if (is_fault != of_faults) continue;
    words.push_back(
        {code.word, code.quantity, code.owner, code.meaning, is_fault ? response_of(code.value) : "", code.turn});
  }
}

void add_counts(std::vector<ExplainedWord>& words) {
  const telemetry_health health{};
  visit_fields(health, [&](const Field& field, const auto& /*value*/) {
    if (field.codes.count > 0 || std::string_view(field.name) == "step") return;
    words.push_back({field.name, "count", "telemetry_health", field.meaning, "", ""});
  });
}

void add_verdicts(std::vector<ExplainedWord>& words) {
  for (int k = 0; k <= static_cast<int>(Outcome::kIncomplete); ++k) {
    const auto outcome = static_cast<Outcome>(k);
    std::string word(word_of(outcome));
    std::ranges::replace(word, ' ', '_');
    const bool is_by_criteria =
        outcome == Outcome::kNotJudged || outcome == Outcome::kMissed || outcome == Outcome::kUnsafe;
    words.push_back(
        {std::move(word), "verdict", "", std::string(meaning_of(outcome)), "",
         is_by_criteria ? "[[waypoint]], keep_out_radius_m, or [[limit]] in place of a default criterion" : ""});
  }
}

}  // namespace

std::vector<ExplainedWord> explained_words() {
  std::vector<ExplainedWord> words;
  add_codes(true, words);
  add_counts(words);
  add_verdicts(words);
  add_codes(false, words);
  return words;
}

}  // namespace vbar::report
