#include "host_sim/app/limit_verdict.h"

#include <span>

#include <fmt/core.h>
#include <fmt/format.h>

#include "host_sim/app/exit_codes.h"
#include "host_sim/app/flown_mission.h"
#include "host_sim/check/limit_check.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/text_file.h"

namespace vbar::app {
namespace {

namespace fs = std::filesystem;

std::vector<mission::Limit> own_limits(const fs::path& run) {
  return mission::load_limits(run / kMissionCopy, overrides_of_run(run));
}

std::vector<mission::Limit> limits_for(const fs::path& run, const fs::path& limits_file) {
  const bool own = limits_file.empty();
  std::vector<mission::Limit> limits =
      own ? own_limits(run) : mission::load_limits(limits_file, std::span<const std::string>());
  if (limits.empty())
    throw Refused(fmt::format("{}: no [[limit]]{}", (own ? run / kMissionCopy : limits_file).string(),
                              own ? "; --limits names a file that has some" : ""));
  return limits;
}

void add(CheckedRun& run, const std::string& name, const std::string& value, const std::string& failure) {
  fmt::print("  {:<6} {:<44} {}\n", failure.empty() ? "met" : "MISSED", name, failure.empty() ? value : failure);
  run.suite.cases.push_back({name, failure});
  run.passed = run.passed && failure.empty();
}

CheckedRun checked_by(const fs::path& folder, const campaign::Json& summary,
                      const std::vector<mission::Limit>& limits) {
  const campaign::Numbers numbers = campaign::numbers_of(summary);
  CheckedRun run{.suite = {.name = folder.string(), .duration_s = 0.0, .cases = {}}};
  if (summary.contains("wall_s") && summary["wall_s"].is_number()) run.suite.duration_s = summary["wall_s"];
  const bool complete = summary.contains("complete") && summary["complete"] == true;
  add(run, "complete", "", complete ? "" : "the run did not reach its end");
  for (const check::LimitResult& result : check::check_limits(limits, numbers))
    add(run, result.limit.key, result.value ? fmt::format("{:g}, {}", *result.value, check::text_of(result.limit)) : "",
        result.missed);
  return run;
}

}  // namespace

campaign::Json summary_json_of(const fs::path& run) {
  const fs::path file = report::summary_file(run);
  try {
    return campaign::Json::parse(files::read_text_file(file));
  } catch (const std::exception& error) {
    throw Refused(fmt::format("{}: not the summary of a run: {}", file.string(), error.what()));
  }
}

CheckedRun checked_run(const fs::path& folder, const fs::path& limits_file) {
  const campaign::Json summary = summary_json_of(folder);
  const std::vector<mission::Limit> limits = limits_for(folder, limits_file);
  fmt::print("{}\n", folder.string());
  return checked_by(folder, summary, limits);
}

void print_own_limits(const fs::path& run_folder) {
  const std::vector<mission::Limit> limits = own_limits(run_folder);
  if (limits.empty()) return;
  fmt::print("limits\n");
  static_cast<void>(checked_by(run_folder, summary_json_of(run_folder), limits));
}

}  // namespace vbar::app
