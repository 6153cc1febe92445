#include "host_sim/cli/verdicts.h"

#include <span>
#include <utility>

#include <fmt/core.h>
#include <fmt/format.h>

#include "host_sim/campaign/case_records.h"
#include "host_sim/report/json_file.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/summary_json.h"
#include "host_sim/simulation/exit_codes.h"
#include "host_sim/simulation/limit_check.h"
#include "host_sim/simulation/recorded_mission.h"

namespace vbar::app {

namespace {

/// Returns the radius that the flight software uses: a waypoint without a radius, or with zero, has that of guidance.
double keep_out_of(const mission::Waypoint& waypoint, const mission::Guidance& guidance) {
  const double own_m = waypoint.keep_out_radius_m.value_or(0.0);
  return own_m > 0.0 ? own_m : guidance.configuration.keep_out_radius_m;
}

std::vector<report::JudgedLimit> judged_limits(const mission::Mission& mission, const report::RunRecord& record) {
  if (mission.limits.empty()) return {};
  const campaign::Json summary = campaign::Json::parse(report::summary_json(record.summary, record.waypoints));
  std::vector<report::JudgedLimit> judged;
  for (const check::LimitResult& result : check::check_limits(mission.limits, campaign::numbers_of(summary)))
    judged.push_back({result.limit.key, result.missed});
  return judged;
}

}  // namespace

report::Goals goals_of(const mission::Mission& mission) {
  report::Goals goals;
  goals.approaches = mission.guidance.mode == mission::Mode::kApproach;
  goals.retreats = mission.guidance.mode == mission::Mode::kRetreat;
  goals.keep_out_radius_m = mission.guidance.configuration.keep_out_radius_m;
  goals.dv_max_mps = mission.guidance.configuration.maximum_dv;
  for (const mission::Waypoint& waypoint : mission.waypoints)
    goals.waypoints.push_back({waypoint.index, fsw::seconds(waypoint.time - mission.epoch),
                               keep_out_of(waypoint, mission.guidance), waypoint.a_roe_m.norm()});
  return goals;
}

void put_verdict(const mission::Mission& mission, report::RunRecord& record) {
  report::Goals goals = goals_of(mission);
  goals.limits = judged_limits(mission, record);
  report::Verdict verdict = report::verdict_of(record, goals);
  record.summary.verdict = report::word_of(verdict.outcome);
  record.summary.verdict_reason = std::move(verdict.reason);
  record.summary.missed_waypoints = std::move(verdict.missed_waypoints);
}

std::optional<std::string> missing_output(const report::FlightOutput& output) {
  if (output.steps == 0) return std::nullopt;
  if (output.steps_failed == output.steps)
    return fmt::format("the flight software failed at each of its {} steps, the last with status {}", output.steps,
                       output.last_status);
  if (output.steps_silent == output.steps)
    return fmt::format("the flight software answered none of its {} steps with a packet", output.steps);
  if (output.packets > 0 && output.packets_invalid == output.packets)
    return fmt::format("none of the {} packets of the flight software in {} steps could be read", output.packets,
                       output.steps);
  return std::nullopt;
}

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
  try {
    return report::read_json_file(report::summary_file(run));
  } catch (const std::exception& error) {
    throw Refused(error.what());
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
