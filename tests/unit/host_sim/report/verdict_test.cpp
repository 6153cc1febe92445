// Verdicts on records made by hand: a target on the along-track axis, two waypoints, criteria computed by hand.

#include "host_sim/report/verdict.h"

#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/report/sections/html_report.h"
#include "host_sim/report/statistics.h"
#include "host_sim/report/summarise.h"

namespace vbar::report::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double kStep_s = 60.0, kEnd_s = 7200.0;

/// From 1000 m to 100 m in an hour, there for another hour; waypoint 1 after an hour, waypoint 2 at the end.
RunRecord flown_run() {
  RunRecord record;
  record.summary.complete = true;
  for (double time_s = 0.0; time_s <= kEnd_s; time_s += kStep_s) {
    TruthRow truth;
    truth.time_s = time_s;
    const bool is_first_leg = time_s < 3600.0;
    truth.relative_position_rtn = {0.0, is_first_leg ? -1000.0 + 0.25 * time_s : -100.0, 0.0};
    truth.relative_velocity_rtn = {0.0, is_first_leg ? 0.25 : 0.0, 0.0};
    record.truth.push_back(truth);
    EstimateRow estimate;
    estimate.time_s = time_s;
    estimate.navigation_valid = 1;
    estimate.mode = mode_command::kModeApproach;
    estimate.relative_position_rtn = truth.relative_position_rtn;
    record.estimates.push_back(estimate);
  }
  for (const auto& [index, time_s, place_m] : {std::tuple{0, 0.0, -1000.0}, {1, 3600.0, -100.0}, {2, kEnd_s, -100.0}}) {
    WaypointRow row;
    row.index = index;
    row.time_s = time_s;
    row.desired_position_rtn = row.actual_position_rtn = {0.0, place_m, 0.0};
    record.waypoints.push_back(row);
  }
  record.summary.maneuvers = 2;
  record.summary.health.emplace();
  return record;
}

Goals goals() {
  Goals goals;
  goals.approaches = true;
  goals.keep_out_radius_m = 10.0;
  goals.waypoints = {{0, 0.0, 10.0, 20.0}, {1, 3600.0, 10.0, 100.0}, {2, kEnd_s, 20.0, 100.0}};
  return goals;
}

std::string line(const RunRecord& record, const Goals& asked) {
  const Verdict verdict = verdict_of(record, asked);
  return std::string(word_of(verdict.outcome)) + ": " + verdict.reason;
}

// The margins are 90 m (100 less 10) and 80 m (100 less 20): a fifth of the smaller is 16 m. The legs are 900 and 0 m.
// The start, with a margin of 10 m, is no goal.
TEST(Verdict, AcceptedControlErrorIsAShareOfLegAndMargin) {
  const std::vector<double> accepted_m = accepted_control_error_m(flown_run(), goals());
  ASSERT_EQ(accepted_m.size(), 3U);
  EXPECT_NEAR(accepted_m[1], 16.45, 1e-12);
  EXPECT_NEAR(accepted_m[2], 16.0, 1e-12);
}

TEST(Verdict, AchievedWithinTheAcceptedErrors) {
  RunRecord record = flown_run();
  record.waypoints[1].control_error_m = 16.4;
  EXPECT_EQ(line(record, goals()), "achieved: 2 waypoints reached, largest control error 16.4 m at waypoint 1");
}

TEST(Verdict, MissedNamesWaypointsAndErrors) {
  RunRecord record = flown_run();
  record.waypoints[1].control_error_m = 16.5;
  record.waypoints[2].control_error_m = 15.9;
  const Verdict verdict = verdict_of(record, goals());
  EXPECT_EQ(verdict.outcome, Outcome::kMissed);
  EXPECT_EQ(verdict.reason, "waypoint 1 by 16.5 m (16.45 m accepted)");
  EXPECT_THAT(verdict.missed_waypoints, ElementsAre(1));
  record.waypoints[1].control_error_m = std::nan("");
  EXPECT_EQ(verdict_of(record, goals()).outcome, Outcome::kMissed) << "an error that is not a number is not accepted";
}

TEST(Verdict, FaultsOfScenarioOrFlightSoftwareAreNamed) {
  RunRecord record = flown_run();
  record.summary.health->faults = telemetry_health::kFaultHold;
  EXPECT_THAT(line(record, goals()), StartsWith("achieved with faults: "));
  EXPECT_THAT(line(record, goals()), HasSubstr("raised hold"));
  record.summary.health->faults = 0;
  record.faults.emplace_back();
  EXPECT_THAT(line(record, goals()), HasSubstr("faults: 1 injected"));
  record.faults.clear();
  record.summary.flight_output = {.steps = 121, .steps_failed = 3, .last_status = 12345};
  EXPECT_THAT(line(record, goals()), HasSubstr("3 of 121 steps failed, the last with status 12345"));
}

TEST(Verdict, NamesATestbedWhoseTwinTookOver) {
  RunRecord record = flown_run();
  record.summary.testbeds["tron"]["handed_over_h"] = 0.5;
  EXPECT_THAT(line(record, goals()), StartsWith("achieved with faults: "));
  EXPECT_THAT(line(record, goals()), HasSubstr("testbed tron handed over to its digital twin at 0.500 h"));
  record.waypoints[1].control_error_m = 20.0;
  EXPECT_THAT(line(record, goals()), StartsWith("missed: waypoint 1 by 20 m"));
  EXPECT_THAT(line(record, goals()), HasSubstr("; testbed tron handed over to its digital twin at 0.500 h"));
}

TEST(Verdict, NavigationIsLostWhenItEndedBeforeAWaypoint) {
  RunRecord record = flown_run();
  for (EstimateRow& row : record.estimates) row.navigation_valid = row.time_s < 1800.0 ? 1 : 0;
  EXPECT_EQ(line(record, goals()), "navigation lost: at 0.500 h, no valid estimate at waypoint 1");
  for (EstimateRow& row : record.estimates) row.navigation_valid = row.time_s < 1800.0 || row.time_s >= 3600.0 ? 1 : 0;
  EXPECT_EQ(verdict_of(record, goals()).outcome, Outcome::kAchieved) << "an outage between waypoints is none at them";
  record.estimates.back().navigation_valid = 0;
  record.waypoints.pop_back();
  EXPECT_EQ(line(record, goals()), "navigation lost: at 2.000 h, no valid estimate at the end");
}

TEST(Verdict, FlightSoftwareThatReportsNoEstimateIsJudgedByItsFlight) {
  RunRecord record = flown_run();
  for (EstimateRow& row : record.estimates) row.navigation_valid = 0;
  EXPECT_EQ(verdict_of(record, goals()).outcome, Outcome::kAchieved);
  record.summary.never_navigated = true;
  EXPECT_THAT(line(record, goals()), StartsWith("never navigated: no estimate was valid in 121 steps"));
}

TEST(Verdict, RetreatIsAnEndOfTheApproachUnlessCommanded) {
  RunRecord record = flown_run();
  record.estimates[30].mode = mode_command::kModeRetreat;
  EXPECT_EQ(line(record, goals()), "retreated: at 0.500 h");
  Goals asked = goals();
  asked.retreats = true;
  EXPECT_EQ(verdict_of(record, asked).outcome, Outcome::kAchieved);
}

// The leg to waypoint 2 has a radius of 20 m, the one before of 10 m.
TEST(Verdict, UnsafeIsATrueDistanceBelowTheRadiusOfTheLeg) {
  RunRecord record = flown_run();
  Goals asked = goals();
  record.truth.back().relative_position_rtn = {0.0, -15.0, 0.0};
  EXPECT_EQ(line(record, asked), "unsafe: true distance 15 m at 2.000 h, keep-out radius 20 m");
  asked.waypoints[2].keep_out_radius_m = 10.0;
  EXPECT_EQ(verdict_of(record, asked).outcome, Outcome::kAchieved);
}

TEST(Verdict, TheMostSevereFindingGivesTheWord) {
  RunRecord record = flown_run();
  record.waypoints[2].control_error_m = 50.0;
  record.truth.back().relative_position_rtn = {0.0, -15.0, 0.0};
  EXPECT_EQ(line(record, goals()),
            "unsafe: true distance 15 m at 2.000 h, keep-out radius 20 m; missed waypoint 2 by 50 m (16 m accepted)");
}

TEST(Verdict, ALimitReplacesTheCriterionOnItsNumber) {
  RunRecord record = flown_run();
  record.waypoints[2].control_error_m = 50.0;
  Goals asked = goals();
  asked.limits = {{"waypoints.2.control_error_m", ""}};
  EXPECT_EQ(verdict_of(record, asked).outcome, Outcome::kAchieved);
  asked.limits = {{"dv_mps", "dv_mps is 4, not at most 3"}, {"waypoints.2.control_error_m", ""}};
  EXPECT_EQ(line(record, asked), "missed: dv_mps is 4, not at most 3");
  record.truth.back().relative_position_rtn = {0.0, -15.0, 0.0};
  asked.limits = {{kMinDistanceKey, ""}, {"waypoints.2.control_error_m", ""}};
  EXPECT_EQ(verdict_of(record, asked).outcome, Outcome::kAchieved);
  asked.limits[0].missed = "min_distance_m is 15, not at least 16";
  EXPECT_EQ(line(record, asked), "unsafe: min_distance_m is 15, not at least 16");
}

TEST(Verdict, ARunBeforeItsFirstWaypointIsNotJudged) {
  RunRecord record = flown_run();
  record.waypoints.resize(1);
  record.truth.resize(31);
  record.estimates.resize(31);
  EXPECT_EQ(line(record, goals()),
            "not judged: navigation valid at the end; the run ended at 0.500 h, before waypoint 1");
  Goals asked = goals();
  asked.limits = {{"dv_mps", ""}};
  EXPECT_THAT(line(record, asked), StartsWith("achieved: 1 limit met"));
  asked = goals();
  asked.approaches = false;
  EXPECT_EQ(line(record, asked), "achieved: navigation valid at the end") << "nothing but navigation was asked for";
}

TEST(Verdict, GuidanceThatRefusesEveryPlanSaysWhy) {
  RunRecord record = flown_run();
  record.summary.maneuvers = 0;
  record.summary.health->holds = 7;
  record.summary.health->faults_present = telemetry_health::kFaultHold;
  Goals asked = goals();
  asked.dv_max_mps = 0.02;
  const std::string sentence =
      "no burn was flown, guidance refused every plan 7 times: a burn above guidance.dv_max_mps = 0.02 m/s is refused "
      "whole";
  EXPECT_EQ(line(record, asked), "missed: " + sentence);
  record.waypoints.resize(1);
  EXPECT_THAT(line(record, asked), StartsWith("not judged: ")) << "no waypoint was passed yet";
  EXPECT_THAT(line(record, asked), HasSubstr(sentence));
  record.summary.health->plans_unsafe = 3;
  EXPECT_THAT(line(record, asked), HasSubstr("3 plans failed the passive-safety test"));
  record.summary.maneuvers = 1;
  EXPECT_THAT(line(record, asked), testing::Not(HasSubstr("no burn")));
}

TEST(Verdict, AnIncompleteRunHasItsReason) {
  RunRecord record = flown_run();
  record.summary.complete = false;
  record.summary.incomplete_reason = "interrupted";
  EXPECT_EQ(line(record, goals()), "incomplete: interrupted");
}

TEST(Verdict, WordsAreReadBack) {
  for (int k = 0; k <= static_cast<int>(Outcome::kIncomplete); ++k)
    EXPECT_EQ(outcome_of(word_of(static_cast<Outcome>(k))), static_cast<Outcome>(k));
  EXPECT_EQ(outcome_of("splendid"), Outcome::kIncomplete);
}

TEST(Verdict, IsTheBadgeOfThePage) {
  RunRecord record = flown_run();
  record.summary.verdict = "missed";
  record.summary.verdict_reason = "waypoint 1 by 16.5 m (16.45 m accepted)";
  EXPECT_THAT(html_report(record), HasSubstr("<span class=\"status bad\">missed</span>"));
  record.summary.verdict = "achieved with faults";
  EXPECT_THAT(html_report(record), HasSubstr("<span class=\"status caution\">achieved with faults</span>"));
  record.summary.verdict = "achieved";
  EXPECT_THAT(html_report(record), HasSubstr("<span class=\"status good\">achieved</span>"));
}

// A target that passes at 1 m/s, 3 m to the side, halfway between two steps: the straight line is a cubic, too.
TEST(TrueDistance, IsFoundBetweenSteps) {
  RunRecord record;
  for (const double time_s : {0.0, 60.0}) {
    TruthRow row;
    row.time_s = time_s;
    row.relative_position_rtn = {3.0, time_s - 30.0, 0.0};
    row.relative_velocity_rtn = {0.0, 1.0, 0.0};
    record.truth.push_back(row);
  }
  const auto least = min_distance(record);
  ASSERT_TRUE(least.has_value());
  EXPECT_NEAR(least->distance_m, 3.0, 1e-9);
  EXPECT_NEAR(least->time_s, 30.0, 1e-9);
  record.truth[1].time_s = 600.0;
  EXPECT_NEAR(min_distance(record)->distance_m, std::hypot(3.0, 30.0), 1e-9) << "steps too far apart for a cubic";
}

ManeuverRow burn(double time_s, double dv_mps, int waypoint) {
  ManeuverRow row;
  row.waypoint_index = waypoint;
  row.command_time_s = row.execution_time_s = time_s;
  row.accepted = true;
  row.executed_dv_rtn_mps = {0.0, dv_mps, 0.0};
  return row;
}

// 30 kg at 0.02 N: 0.217 m/s last 325.5 s, 0.01 m/s 15 s. A prescribed burn needs no thruster; the last has no next
// one.
TEST(Thrust, BurnsThatWouldNotEndBeforeTheNextAreCounted) {
  RunRecord record;
  record.maneuvers = {burn(0.0, 0.01, 1), burn(100.0, 0.217, 1), burn(400.0, 0.01, 1), burn(410.0, 9.0, -1),
                      burn(1000.0, 0.1, 2)};
  record.summary.thrust = Thrust{.max_thrust_n = 0.02, .mass_kg = 30.0};
  summarise_thrust(record, record.summary);
  EXPECT_EQ(record.summary.thrust->burns, 4);
  EXPECT_EQ(record.summary.thrust->burns_too_long, 1);
  EXPECT_NEAR(record.summary.thrust->longest_burn_s, 325.5, 1e-9);
  EXPECT_NEAR(record.summary.thrust->longest_burn_at_h, 100.0 / 3600.0, 1e-12);
  EXPECT_THAT(thrust_line(record.summary), HasSubstr("1 of 4 burns would last longer"));
  EXPECT_EQ(thrust_line(Summary{}), "");
}

}  // namespace
}  // namespace vbar::report::test
