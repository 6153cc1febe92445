#include "host_sim/campaign/status.h"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "host_sim/campaign_report/campaign.h"
#include "host_sim/files/data_stream.h"
#include "host_sim/files/output_file.h"
#include "host_sim/report/csv_table.h"
#include "host_sim/report/plots/number_text.h"

namespace vbar::campaign {

CaseStatus Standing::status_of(std::size_t number) const {
  CaseStatus status;
  if (const auto found = attempts.of_case.find(number); found != attempts.of_case.end()) {
    status.attempts = found->second.begun;
    status.last_end = found->second.last_end;
    status.state = found->second.flies ? State::kFlying : State::kKilled;
  }
  if (const auto found = results.of_case.find(number); found != results.of_case.end()) {
    status.result = &found->second;
    status.state = found->second.state;
  }
  return status;
}

std::map<State, std::size_t> Standing::counts() const {
  std::map<State, std::size_t> counts;
  for (const Case& one : cases) ++counts[status_of(one.number).state];
  return counts;
}

std::size_t Standing::passed() const {
  std::size_t count = 0;
  for (const auto& [number, result] : results.of_case) count += has_passed(plan, result) ? 1 : 0;
  return count;
}

Progress Standing::progress() const {
  Progress progress{results.of_case.size(), cases.size(), passed()};
  for (const auto& [state, count] : counts()) {
    if (state == State::kFailed || state == State::kOverTime || state == State::kLost) progress.failed += count;
    if (state == State::kFlying) progress.flying += count;
  }
  return progress;
}

std::vector<Case> Standing::left_to_fly(bool retry_failed) const {
  std::vector<Case> left;
  for (const Case& one : cases) {
    const auto found = results.of_case.find(one.number);
    const bool has_flown = found != results.of_case.end() &&
                           (found->second.state == State::kComplete || found->second.state == State::kVoid);
    if (found == results.of_case.end() || (retry_failed && !has_flown)) left.push_back(one);
  }
  return left;
}

Standing read_standing(const Folder& folder) {
  folder.require_campaign();
  Standing standing;
  standing.plan = read_plan(folder.plan());
  if (files::sha256_of(files::read_text_file(folder.cases())) != standing.plan.cases_sha256)
    throw std::runtime_error(folder.cases().string() +
                             ": differs from the table that the campaign began with (SHA-256); restore it, or begin a "
                             "new campaign");
  standing.cases = read_cases(folder.cases(), standing.plan.keys);
  if (standing.cases.size() != standing.plan.cases)
    throw std::runtime_error(fmt::format("{}: {} cases, but campaign.json states {}", folder.cases().string(),
                                         standing.cases.size(), standing.plan.cases));
  standing.attempts = read_attempts(folder.attempt_files());
  standing.results = read_results(folder.result_files());
  for (const auto& [number, result] : standing.results.of_case)
    if (number >= standing.cases.size() || result.case_sha256 != identity_of(standing.plan, standing.cases[number]))
      standing.results.conflicts.push_back(
          fmt::format("case {}: its result is that of other keys than campaign.json and cases.csv state", number));
  return standing;
}

std::string progress_text(const Progress& progress, double left_s) {
  return fmt::format("{} of {} cases done, {} passed, {} failed, {} flying{}", progress.done, progress.all,
                     progress.passed, progress.failed, progress.flying,
                     left_s < 0.0 ? std::string() : ", " + report::duration_text(left_s) + " left");
}

namespace {

using report::append_text;
using report::append_value;

/// Returns the keys of all cases in the order of their first appearance, then criteria without any value.
std::vector<std::string> number_keys(const Standing& standing) {
  std::vector<std::string> keys;
  std::set<std::string> seen;
  const auto add = [&](const std::string& key) {
    if (seen.insert(key).second) keys.push_back(key);
  };
  for (const auto& [number, result] : standing.results.of_case)
    for (const auto& [key, value] : result.numbers) add(key);
  for (const PassCriterion& criterion : standing.plan.passes) add(criterion.key);
  return keys;
}

std::string head_line(const Standing& standing, const std::vector<std::string>& numbers) {
  std::string line = "case,seed";
  const auto add = [&line](const std::string& name) {
    line += ',';
    append_text(line, name);
  };
  for (const std::string& key : standing.plan.keys) add(key);
  line +=
      ",state,verdict,passed,failed_limits,reason,attempts,host,processor,wall_s,cpu_s,commands_sha256,telemetry_"
      "sha256,"
      "waypoints_sha256,folder";
  for (const std::string& key : numbers) add(key);
  return line + "\n";
}

std::string passed_text(const Plan& plan, const Result& result) {
  if (result.state != State::kComplete) return {};
  return has_passed(plan, result) ? "1" : "0";
}

/// A folder of a kept run may have been outdone, or removed by hand.
std::string folder_text(const Result& result, const std::set<std::string>& missing) {
  return missing.contains(result.folder) ? std::string() : result.folder;
}

void append_result(std::string& line, const Standing& standing, const CaseStatus& status) {
  const Result none{};
  const Result& result = status.result == nullptr ? none : *status.result;
  const bool has = status.result != nullptr;
  const auto text = [&line](const std::string& cell) {
    line += ',';
    append_text(line, cell);
  };
  const bool has_flown = has && result.state == State::kComplete;
  text(std::string(name_of(status.state)));
  text(result.verdict);
  text(has ? passed_text(standing.plan, result) : "");
  text(has_flown ? fmt::format("{}", fmt::join(failed_limits(standing.plan, result), "; ")) : "");
  text(has ? result.reason : status.last_end);
  line += fmt::format(",{}", status.attempts);
  text(result.host);
  text(result.processor);
  line += has ? fmt::format(",{:.3f},{:.3f}", result.wall_s, result.cpu_s) : ",,";
  for (const std::string* cell : {&result.commands_sha256, &result.telemetry_sha256, &result.waypoints_sha256})
    text(*cell);
}

void append_numbers(std::string& line, const Result* result, const std::vector<std::string>& keys) {
  const std::map<std::string, double> numbers =
      result == nullptr ? std::map<std::string, double>()
                        : std::map<std::string, double>(result->numbers.begin(), result->numbers.end());
  for (const std::string& key : keys) {
    line += ',';
    if (const auto found = numbers.find(key); found != numbers.end()) append_value(line, found->second);
  }
}

std::string text_with(const Standing& standing, const std::set<std::string>& missing_folders) {
  const std::vector<std::string> keys = number_keys(standing);
  std::string text = head_line(standing, keys);
  for (const Case& one : standing.cases) {
    const CaseStatus status = standing.status_of(one.number);
    text += fmt::format("{},{}", one.number, one.seed);
    for (const std::string& value : one.values) {
      text += ',';
      append_text(text, value);
    }
    append_result(text, standing, status);
    text += ',';
    append_text(text, status.result == nullptr ? std::string() : folder_text(*status.result, missing_folders));
    append_numbers(text, status.result, keys);
    text += '\n';
  }
  return text;
}

}  // namespace

std::string results_text(const Standing& standing) {
  return text_with(standing, {});
}

void write_results(const Folder& folder, const Standing& standing) {
  std::set<std::string> missing;
  std::error_code error;
  for (const auto& [number, result] : standing.results.of_case)
    if (!result.folder.empty() && !std::filesystem::is_directory(folder.root() / result.folder, error))
      missing.insert(result.folder);
  files::replace_text_file(folder.results(), text_with(standing, missing));
}

std::vector<campaign_report::JudgedRequirement> judge_requirements(const Folder& folder, const Standing& standing) {
  if (standing.plan.requirements.empty() || !standing.left_to_fly(false).empty()) return {};
  std::istringstream text(text_with(standing, {}));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return campaign_report::judge_requirements(campaign_report::read_campaign(folder.root(), std::move(lines)),
                                             folder.root().string());
}

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

std::string status_text(const Standing& standing, const std::vector<campaign_report::JudgedRequirement>& requirements,
                        const std::vector<std::string>& jobs) {
  std::string text = fmt::format("{}: {} cases: {}; {} passed\n", standing.plan.name, standing.cases.size(),
                                 states_text(standing), standing.passed());
  text += verdicts_text(standing);
  if (standing.left_to_fly(false).empty())
    for (const campaign_report::JudgedRequirement& judged : requirements) text += judged.sentence + "\n";
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
