#include "host_sim/campaign/collect.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "host_sim/report/csv_table.h"
#include "host_sim/report/text_file.h"

namespace vbar::campaign {
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

}  // namespace vbar::campaign
