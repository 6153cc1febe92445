#include "host_sim/campaign/case_state.h"

#include <fmt/format.h>

#include "host_sim/files/sha256.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/text_file.h"

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

}  // namespace vbar::campaign
