#include "host_sim/report/verdict.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "host_sim/report/csv_table.h"
#include "host_sim/report/run_series.h"
#include "host_sim/report/statistics.h"

namespace vbar::report {
namespace {

constexpr double kShareOfLeg = 5e-4, kShareOfMargin = 0.2;
constexpr std::size_t kMostNamed = 3;  // waypoints of a sentence

struct NamedOutcome {
  Outcome outcome;
  std::string_view word, meaning;
};

constexpr std::array kOutcomes{
    NamedOutcome{Outcome::kAchieved, "achieved", "every criterion of the mission is met"},
    NamedOutcome{
        Outcome::kAchievedWithFaults, "achieved with faults",
        "every criterion is met although faults were injected, the flight software raised some or a testbed failed"},
    NamedOutcome{Outcome::kNotJudged, "not judged",
                 "the run ended before its first waypoint, and no [[limit]] of the mission judges it"},
    NamedOutcome{Outcome::kMissed, "missed",
                 "a waypoint was passed with a control error that is not accepted, or a [[limit]] is missed"},
    NamedOutcome{Outcome::kNavigationLost, "navigation lost",
                 "navigation had a valid estimate and lost it: there was none at a waypoint or at the end"},
    NamedOutcome{Outcome::kRetreated, "retreated", "the flight software left the approach by a retreat"},
    NamedOutcome{Outcome::kNeverNavigated, "never navigated", "no estimate was valid in the whole run"},
    NamedOutcome{Outcome::kUnsafe, "unsafe", "the true distance was below the keep-out radius"},
    NamedOutcome{Outcome::kIncomplete, "incomplete",
                 "the run did not reach its end, or the flight software answered none of its steps"}};

struct Finding {
  Outcome outcome;
  std::string text;
};

std::string hours_text(double time_s) {
  return fmt::format("{:.3f} h", time_s / 3600.0);
}

std::string metres_text(double value) {
  return fmt::format("{:.4g} m", value);
}

double distance(const Triple& a, const Triple& b) {
  return magnitude({a[0] - b[0], a[1] - b[1], a[2] - b[2]});
}

double keep_out_at(const Goals& goals, double time_s) {
  const auto ahead = std::ranges::find_if(goals.waypoints, [&](const Goal& goal) { return goal.time_s >= time_s; });
  return ahead == goals.waypoints.end() ? goals.keep_out_radius_m : ahead->keep_out_radius_m;
}

bool has_limit(const Goals& goals, const std::string& key) {
  return std::ranges::find(goals.limits, key, &JudgedLimit::key) != goals.limits.end();
}

/// Flight software that reports no estimate is not judged by its estimates.
bool reports_navigation(const RunRecord& record) {
  return record.summary.never_navigated || !record.of<telemetry_navigation>().empty() ||
         std::ranges::any_of(record.estimates, [](const EstimateRow& row) { return row.navigation_valid != 0; });
}

/// Whether the last estimate until a time is valid.
bool is_valid_at(const RunRecord& record, double time_s) {
  const auto after = std::ranges::upper_bound(record.estimates, time_s, {}, &EstimateRow::time_s);
  return after != record.estimates.begin() && std::prev(after)->navigation_valid != 0;
}

/// Returns when the estimate that was valid before `time_s` became invalid; empty if there had been none.
std::optional<double> lost_before(const RunRecord& record, double time_s) {
  std::optional<double> lost;
  bool was_valid = false;
  for (const EstimateRow& row : record.estimates) {
    if (row.time_s > time_s) break;
    if (was_valid && row.navigation_valid == 0) lost = row.time_s;
    was_valid = row.navigation_valid != 0;
  }
  return was_valid ? std::nullopt : lost;
}

void judge_navigation(const RunRecord& record, const Goals& goals, std::vector<Finding>& findings) {
  if (!reports_navigation(record)) return;
  if (record.summary.never_navigated) {
    findings.push_back(
        {Outcome::kNeverNavigated, fmt::format("no estimate was valid in {} steps", record.estimates.size())});
    return;
  }
  for (const WaypointRow& row : reached_waypoints(record)) {
    if (has_limit(goals, fmt::format("waypoints.{}.navigation_error_m", row.index))) continue;
    if (is_valid_at(record, row.time_s)) continue;
    const std::optional<double> lost = lost_before(record, row.time_s);
    findings.push_back({Outcome::kNavigationLost,
                        lost ? fmt::format("at {}, no valid estimate at waypoint {}", hours_text(*lost), row.index)
                             : fmt::format("no valid estimate until waypoint {}", row.index)});
    return;
  }
  if (record.estimates.empty()) return;
  if (const auto lost = lost_before(record, record.estimates.back().time_s))
    findings.push_back(
        {Outcome::kNavigationLost, fmt::format("at {}, no valid estimate at the end", hours_text(*lost))});
}

void judge_retreat(const RunRecord& record, const Goals& goals, std::vector<Finding>& findings) {
  if (goals.retreats) return;
  const auto retreat = std::ranges::find(record.estimates, int{mode_command::kModeRetreat}, &EstimateRow::mode);
  if (retreat != record.estimates.end()) findings.push_back({Outcome::kRetreated, "at " + hours_text(retreat->time_s)});
}

void judge_distance(const RunRecord& record, const Goals& goals, std::vector<Finding>& findings) {
  if (has_limit(goals, kMinDistanceKey)) return;
  std::optional<TrueDistance> worst;
  double worst_radius_m = 0.0;
  for_each_distance(record, [&](const TrueDistance& one) {
    const double radius_m = keep_out_at(goals, one.time_s);
    if (!(one.distance_m < radius_m)) return;
    if (worst && radius_m - one.distance_m <= worst_radius_m - worst->distance_m) return;
    worst = one;
    worst_radius_m = radius_m;
  });
  if (worst)
    findings.push_back(
        {Outcome::kUnsafe, fmt::format("true distance {} at {}, keep-out radius {}", metres_text(worst->distance_m),
                                       hours_text(worst->time_s), metres_text(worst_radius_m))});
}

void judge_limits(const Goals& goals, std::vector<Finding>& findings) {
  for (const JudgedLimit& limit : goals.limits) {
    if (limit.missed.empty()) continue;
    findings.push_back({limit.key == kMinDistanceKey ? Outcome::kUnsafe : Outcome::kMissed, limit.missed});
  }
}

void judge_control(const RunRecord& record, const Goals& goals, Verdict& verdict, std::vector<Finding>& findings) {
  if (!goals.approaches) return;
  const std::vector<double> accepted_m = accepted_control_error_m(record, goals);
  std::string text;
  for (std::size_t k = 0; k < record.waypoints.size(); ++k) {
    const WaypointRow& row = record.waypoints[k];
    if (is_start(record, row) || has_limit(goals, fmt::format("waypoints.{}.control_error_m", row.index))) continue;
    if (row.control_error_m <= accepted_m[k]) continue;  // NaN is not
    verdict.missed_waypoints.push_back(row.index);
    if (verdict.missed_waypoints.size() > kMostNamed) continue;
    text += fmt::format("{}waypoint {} by {} ({} accepted)", text.empty() ? "" : ", ", row.index,
                        metres_text(row.control_error_m), metres_text(accepted_m[k]));
  }
  if (verdict.missed_waypoints.size() > kMostNamed)
    text += fmt::format(" and {} more", verdict.missed_waypoints.size() - kMostNamed);
  if (!text.empty()) findings.push_back({Outcome::kMissed, text});
}

/// Returns why guidance that rejected every plan to the end flew no burn; empty if it flew some or is not holding.
std::string refusal(const RunRecord& record, const Goals& goals) {
  const std::optional<telemetry_health>& health = record.summary.health;
  const bool is_holding = health && (health->faults_present & telemetry_health::kFaultHold) != 0;
  if (!goals.approaches || record.summary.maneuvers > 0 || !is_holding) return "";
  const std::string cause =
      health->plans_unsafe > 0
          ? fmt::format("{} plans failed the passive-safety test", health->plans_unsafe)
          : fmt::format("a burn above guidance.dv_max_mps = {:g} m/s is refused whole", goals.dv_max_mps);
  return fmt::format("no burn was flown, guidance refused every plan {} times: {}", health->holds, cause);
}

void judge_burns(const RunRecord& record, const Goals& goals, std::vector<Finding>& findings) {
  std::string text = refusal(record, goals);
  if (!text.empty() && !reached_waypoints(record).empty()) findings.push_back({Outcome::kMissed, std::move(text)});
}

std::string achievement(const RunRecord& record, const Goals& goals) {
  const std::vector<WaypointRow> reached = reached_waypoints(record);
  const double end_s = record.truth.empty() ? 0.0 : record.truth.back().time_s;
  std::string text;
  if (goals.approaches && !reached.empty()) {
    const auto worst = std::ranges::max_element(reached, {}, &WaypointRow::control_error_m);
    text = fmt::format("{} waypoint{} reached, largest control error {} at waypoint {}", reached.size(),
                       reached.size() == 1 ? "" : "s", metres_text(worst->control_error_m), worst->index);
  } else if (!goals.limits.empty()) {
    text = fmt::format("{} limit{} met", goals.limits.size(), goals.limits.size() == 1 ? "" : "s");
  } else {
    text = is_valid_at(record, end_s) ? "navigation valid at the end" : "navigation not yet valid at the end";
  }
  const auto ahead = std::ranges::find_if(goals.waypoints, [&](const Goal& goal) { return goal.time_s > end_s; });
  if (goals.approaches && ahead != goals.waypoints.end())
    text += fmt::format("; the run ended at {}, before waypoint {}", hours_text(end_s), ahead->index);
  return text;
}

/// Testbeds whose digital twins took over: what the run shows of them holds until then.
std::string hand_overs(const RunRecord& record) {
  std::string text;
  for (const auto& [testbed, figures] : record.summary.testbeds) {
    const auto found = figures.find(std::string(kHandedOver));
    const auto* const hour = found == figures.end() ? nullptr : std::get_if<double>(&found->second);
    if (hour == nullptr) continue;
    text += fmt::format("{}testbed {} handed over to its digital twin at {}", text.empty() ? "" : ", ", testbed,
                        hours_text(3600.0 * *hour));
  }
  return text;
}

std::string faults_text(const RunRecord& record) {
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (!record.faults.empty()) add(fmt::format("{} injected", record.faults.size()));
  const std::optional<telemetry_health>& health = record.summary.health;
  const Codes words{codes::telemetry_health_kFault, static_cast<int>(std::size(codes::telemetry_health_kFault)), true};
  if (health && health->faults != 0) add(fmt::format("raised {}", word_of(words, health->faults)));
  if (const std::string twins = hand_overs(record); !twins.empty()) add(twins);
  const FlightOutput& output = record.summary.flight_output;
  if (output.steps_failed > 0)
    add(fmt::format("{} of {} steps failed, the last with status {}", output.steps_failed, output.steps,
                    output.last_status));
  if (output.packets_invalid > 0) add(fmt::format("{} of {} packets invalid", output.packets_invalid, output.packets));
  return text;
}

/// A mission with waypoints ahead whose run judged nothing.
bool is_too_short(const RunRecord& record, const Goals& goals) {
  return goals.approaches && goals.limits.empty() && reached_waypoints(record).empty();
}

}  // namespace

std::vector<double> accepted_control_error_m(const RunRecord& record, const Goals& goals) {
  if (record.truth.empty()) return std::vector<double>(record.waypoints.size(), 0.0);
  std::optional<double> margin_m;
  for (const Goal& goal : goals.waypoints) {
    if (goal.time_s <= record.truth.front().time_s) continue;
    const double own_m = std::max(0.0, goal.size_m - goal.keep_out_radius_m);
    margin_m = margin_m ? std::min(*margin_m, own_m) : own_m;
  }
  std::vector<double> accepted_m;
  Triple from = record.truth.front().relative_position_rtn;
  for (const WaypointRow& row : record.waypoints) {
    accepted_m.push_back(kShareOfLeg * distance(from, row.desired_position_rtn) +
                         kShareOfMargin * margin_m.value_or(0.0));
    from = row.desired_position_rtn;
  }
  return accepted_m;
}

Verdict verdict_of(const RunRecord& record, const Goals& goals) {
  if (!record.summary.complete) return {Outcome::kIncomplete, record.summary.incomplete_reason, {}};
  Verdict verdict;
  std::vector<Finding> findings;
  judge_distance(record, goals, findings);
  judge_navigation(record, goals, findings);
  judge_retreat(record, goals, findings);
  judge_control(record, goals, verdict, findings);
  judge_burns(record, goals, findings);
  judge_limits(goals, findings);
  if (findings.empty()) {
    const std::string faults = faults_text(record);
    verdict.outcome = is_too_short(record, goals) ? Outcome::kNotJudged
                      : faults.empty()            ? Outcome::kAchieved
                                                  : Outcome::kAchievedWithFaults;
    verdict.reason = achievement(record, goals);
    if (const std::string refused = refusal(record, goals); !refused.empty()) verdict.reason += "; " + refused;
    if (!faults.empty()) verdict.reason += "; faults: " + faults;
    return verdict;
  }
  std::ranges::stable_sort(findings, std::greater{}, &Finding::outcome);
  verdict.outcome = findings.front().outcome;
  for (const Finding& finding : findings) {
    if (!verdict.reason.empty()) verdict.reason += "; ";
    if (finding.outcome != verdict.outcome) verdict.reason += fmt::format("{} ", word_of(finding.outcome));
    verdict.reason += finding.text;
  }
  if (const std::string twins = hand_overs(record); !twins.empty()) verdict.reason += "; " + twins;
  return verdict;
}

std::string_view word_of(Outcome outcome) {
  return std::ranges::find(kOutcomes, outcome, &NamedOutcome::outcome)->word;
}

std::string_view meaning_of(Outcome outcome) {
  return std::ranges::find(kOutcomes, outcome, &NamedOutcome::outcome)->meaning;
}

Outcome outcome_of(std::string_view word) {
  const auto* const found = std::ranges::find(kOutcomes, word, &NamedOutcome::word);
  return found == kOutcomes.end() ? Outcome::kIncomplete : found->outcome;
}

bool is_favourable(Outcome outcome) {
  return outcome <= Outcome::kNotJudged;
}

std::string verdict_line(const Summary& summary) {
  return summary.verdict_reason.empty() ? summary.verdict
                                        : fmt::format("{}: {}", summary.verdict, summary.verdict_reason);
}

}  // namespace vbar::report
