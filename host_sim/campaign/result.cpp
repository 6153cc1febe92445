#include "host_sim/campaign/result.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "host_sim/campaign/folder.h"
#include "host_sim/check/limit_check.h"

namespace vbar::campaign {
namespace {

constexpr std::array<std::pair<State, std::string_view>, 8> kStates{{{State::kComplete, "complete"},
                                                                     {State::kFailed, "failed"},
                                                                     {State::kOverTime, "over_time"},
                                                                     {State::kLost, "lost"},
                                                                     {State::kVoid, "void"},
                                                                     {State::kNotBegun, "not_begun"},
                                                                     {State::kFlying, "flying"},
                                                                     {State::kKilled, "killed"}}};

State state_of(const std::string& name) {
  for (const auto& [state, word] : kStates)
    if (word == name) return state;
  throw std::runtime_error("an unknown state: " + name);
}

bool has_flown(const Result& result) {
  return result.state == State::kComplete || result.state == State::kVoid;
}

void add(Result&& result, AllResults& all) {
  const auto [place, is_new] = all.of_case.try_emplace(result.number, result);
  if (is_new) return;
  Result& before = place->second;
  if (has_flown(before) && has_flown(result) && !before.has_same_outputs(result))
    all.conflicts.push_back(fmt::format("case {}: two flights with different outputs, on {} ({}) and on {} ({})",
                                        result.number, before.host, before.processor, result.host, result.processor));
  if (!has_flown(before)) before = std::move(result);
}

using NameLines = std::map<std::size_t, std::vector<std::string>>;  // lines of one file, by their numbers

Json json_of(const Result& result, std::size_t name_line) {
  Json numbers = Json::array();
  for (const auto& [name, value] : result.numbers) numbers.push_back(value);
  return {{"case", result.number},
          {"attempt", result.attempt},
          {"state", name_of(result.state)},
          {"reason", result.reason},
          {"verdict", result.verdict},
          {"host", result.host},
          {"processor", result.processor},
          {"wall_s", result.wall_s},
          {"cpu_s", result.cpu_s},
          {"commands_sha256", result.commands_sha256},
          {"telemetry_sha256", result.telemetry_sha256},
          {"waypoints_sha256", result.waypoints_sha256},
          {"case_sha256", result.case_sha256},
          {"folder", result.folder},
          {"name_line", name_line},
          {"numbers", std::move(numbers)}};
}

/// Throws an exception for an object that is not a result, or whose line of names is missing.
Result result_of(const Json& json, const NameLines& name_lines) {
  Result result;
  json.at("case").get_to(result.number);
  json.at("attempt").get_to(result.attempt);
  result.state = state_of(json.at("state").get<std::string>());
  json.at("reason").get_to(result.reason);
  result.verdict = json.value("verdict", "");  // an older version of this program wrote none
  json.at("host").get_to(result.host);
  json.at("processor").get_to(result.processor);
  json.at("wall_s").get_to(result.wall_s);
  json.at("cpu_s").get_to(result.cpu_s);
  json.at("commands_sha256").get_to(result.commands_sha256);
  json.at("telemetry_sha256").get_to(result.telemetry_sha256);
  json.at("waypoints_sha256").get_to(result.waypoints_sha256);
  json.at("case_sha256").get_to(result.case_sha256);
  json.at("folder").get_to(result.folder);
  if (!result.folder.empty() && result.folder != Folder("").runs() / name_of_case(result.number))
    throw std::runtime_error("a folder other than that of the case");
  const std::vector<std::string>& names = name_lines.at(json.at("name_line").get<std::size_t>());
  const auto numbers = json.at("numbers").get<std::vector<double>>();
  if (numbers.size() != names.size()) throw std::runtime_error("numbers and names differ in number");
  for (std::size_t k = 0; k < names.size(); ++k) result.numbers.emplace_back(names[k], numbers[k]);
  return result;
}

}  // namespace

std::string_view name_of(State state) {
  return std::ranges::find(kStates, state, &std::pair<State, std::string_view>::first)->second;
}

void ResultFile::append(const Result& result) {
  std::vector<std::string> names;
  for (const auto& [name, value] : result.numbers) names.push_back(name);
  if (name_lines_ == 0 || names != names_) {
    file_.append({{"name_line", ++name_lines_}, {"names", names}}, RecordFile::Sync::kNo);
    names_ = std::move(names);
  }
  file_.append(json_of(result, name_lines_), RecordFile::Sync::kYes);
}

std::vector<std::string> failed_limits(const Plan& plan, const Result& result) {
  std::vector<std::string> keys;
  for (const PassCriterion& criterion : plan.passes)
    if (!check::meets(criterion, find_number(result.numbers, criterion.key)) &&
        std::ranges::find(keys, criterion.key) == keys.end())
      keys.push_back(criterion.key);
  return keys;
}

bool has_passed(const Plan& plan, const Result& result) {
  return result.state == State::kComplete && result.reason.empty() && failed_limits(plan, result).empty();
}

AllResults read_results(const std::filesystem::path& result_files) {
  AllResults all;
  for (const std::filesystem::path& file : record_files(result_files)) {
    const ReadLines read = read_lines_of(file);
    all.damaged_lines += read.damaged;
    NameLines name_lines;
    for (const Json& line : read.lines) {
      try {
        if (line.contains("names"))
          line.at("names").get_to(name_lines[line.at("name_line").get<std::size_t>()]);
        else
          add(result_of(line, name_lines), all);
      } catch (const std::exception&) {
        ++all.damaged_lines;
      }
    }
  }
  return all;
}

}  // namespace vbar::campaign
