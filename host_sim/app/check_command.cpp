// vbar check: the limits of a mission against runs of it.

#include <span>

#include <fmt/core.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/app/commands.h"
#include "host_sim/app/exit_codes.h"
#include "host_sim/app/flown_mission.h"
#include "host_sim/campaign/summary_numbers.h"
#include "host_sim/check/junit_xml.h"
#include "host_sim/check/limit_check.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/text_file.h"

namespace vbar::app {
namespace {

namespace fs = std::filesystem;

struct CheckedRun {
  check::JunitSuite suite;
  bool passed = true;
};

campaign::Json summary_json_of(const fs::path& run) {
  const fs::path file = report::summary_file(run);
  try {
    return campaign::Json::parse(report::read_text_file(file));
  } catch (const std::exception& error) {
    throw Refused(fmt::format("{}: not the summary of a run: {}", file.string(), error.what()));
  }
}

std::vector<mission::Limit> limits_for(const fs::path& run, const fs::path& limits_file) {
  const bool own = limits_file.empty();
  std::vector<mission::Limit> limits = own ? mission::load_limits(run / kMissionCopy, overrides_of_run(run))
                                           : mission::load_limits(limits_file, std::span<const std::string>());
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

CheckedRun checked(const fs::path& folder, const fs::path& limits_file) {
  const campaign::Json summary = summary_json_of(folder);
  const std::vector<mission::Limit> limits = limits_for(folder, limits_file);
  const campaign::Numbers numbers = campaign::numbers_of(summary);
  CheckedRun run{.suite = {.name = folder.string(), .duration_s = 0.0, .cases = {}}};
  if (summary.contains("wall_s") && summary["wall_s"].is_number()) run.suite.duration_s = summary["wall_s"];
  fmt::print("{}\n", folder.string());
  const bool complete = summary.contains("complete") && summary["complete"] == true;
  add(run, "complete", "", complete ? "" : "the run did not reach its end");
  for (const check::LimitResult& result : check::check_limits(limits, numbers))
    add(run, result.limit.key, result.value ? fmt::format("{:g}, {}", *result.value, check::text_of(result.limit)) : "",
        result.missed);
  return run;
}

int print_numbers(const std::vector<fs::path>& run_folders) {
  for (const fs::path& folder : run_folders)
    for (const auto& [key, value] : campaign::numbers_of(summary_json_of(folder)))
      fmt::print("{} = {:g}\n", key, value);
  return kDone;
}

}  // namespace

int check_command(const CheckOptions& options) {
  if (options.numbers) return print_numbers(options.run_folders);
  bool passed = true;
  std::vector<check::JunitSuite> suites;
  for (const fs::path& folder : options.run_folders) {
    CheckedRun run = checked(folder, options.limits);
    passed = passed && run.passed;
    suites.push_back(std::move(run.suite));
  }
  if (!options.junit.empty()) report::replace_text_file(options.junit, check::junit_xml(suites));
  return passed ? kDone : kLimitMissed;
}

}  // namespace vbar::app
