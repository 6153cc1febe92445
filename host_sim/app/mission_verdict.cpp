#include "host_sim/app/mission_verdict.h"

#include <utility>

#include <fmt/format.h>

#include "host_sim/campaign/summary_numbers.h"
#include "host_sim/check/limit_check.h"
#include "host_sim/report/summary_json.h"

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

}  // namespace vbar::app
