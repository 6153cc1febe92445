#include "host_sim/campaign/status.h"

#include <algorithm>

#include <fmt/format.h>

#include "host_sim/campaign/requirement.h"

namespace vbar::campaign {
namespace {

constexpr std::size_t kMaxReasons = 5;

/// Reasons with the number of their cases, most frequent first.
std::vector<std::pair<std::size_t, std::string>> reasons_of(const Standing& standing) {
  std::map<std::string, std::size_t> counts;
  for (const auto& [number, result] : standing.results.of_case) {
    if (!result.reason.empty()) ++counts[fmt::format("{}: {}", name_of(result.state), result.reason)];
    if (result.state != State::kComplete) continue;
    for (const std::string& key : failed_limits(standing.plan, result)) ++counts["limit not met: " + key];
  }
  std::vector<std::pair<std::size_t, std::string>> ranked;
  for (const auto& [reason, count] : counts) ranked.emplace_back(count, reason);
  std::ranges::stable_sort(ranked, std::greater<>(), &std::pair<std::size_t, std::string>::first);
  return ranked;
}

std::string states_text(const Standing& standing) {
  std::vector<std::string> parts;
  for (const auto& [state, count] : standing.counts()) parts.push_back(fmt::format("{} {}", count, name_of(state)));
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// "verdicts: 18 achieved, 2 missed"; empty before the first.
std::string verdicts_text(const Standing& standing) {
  std::map<std::string, std::size_t> counts;
  for (const auto& [number, result] : standing.results.of_case)
    if (!result.verdict.empty()) ++counts[result.verdict];
  std::vector<std::string> parts;
  for (const auto& [verdict, count] : counts) parts.push_back(fmt::format("{} {}", count, verdict));
  return parts.empty() ? "" : fmt::format("verdicts: {}\n", fmt::join(parts, ", "));
}

}  // namespace

std::string status_text(const Standing& standing, const std::vector<std::string>& jobs) {
  std::string text = fmt::format("{}: {} cases: {}; {} passed\n", standing.plan.name, standing.cases.size(),
                                 states_text(standing), standing.passed());
  text += verdicts_text(standing);
  if (standing.plan.require && standing.left_to_fly(false).empty())
    text +=
        judge(*standing.plan.require, standing.passed(), standing.cases.size(), standing.plan.independent).sentence +
        "\n";
  const auto reasons = reasons_of(standing);
  for (std::size_t k = 0; k < std::min(kMaxReasons, reasons.size()); ++k)
    text +=
        fmt::format("  {} {}  {}\n", reasons[k].first, reasons[k].first == 1 ? "case " : "cases", reasons[k].second);
  if (reasons.size() > kMaxReasons) text += fmt::format("  and {} other reasons\n", reasons.size() - kMaxReasons);
  for (const std::string& worker : standing.attempts.living_workers)
    text += fmt::format("worker {} is flying\n", worker);
  for (const std::string& job : jobs) text += fmt::format("job {}\n", job);
  if (standing.results.damaged_lines > 0)
    text += fmt::format("{} lines of the result files are damaged and count as no result\n",
                        standing.results.damaged_lines);
  for (const std::string& conflict : standing.results.conflicts) text += conflict + "\n";
  return text;
}

}  // namespace vbar::campaign
