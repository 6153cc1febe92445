// The keys by which criteria and results.csv name the numbers of a summary.

#include "host_sim/campaign/summary_numbers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/campaign/requirement.h"
#include "host_sim/campaign/result.h"
#include "host_sim/campaign_report/pass_rate.h"
#include "host_sim/report/summary_json.h"

namespace vbar::campaign {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

report::Summary summary() {
  report::Summary summary;
  summary.mission = "m";
  summary.wall_s = 3.0;
  summary.navigation_error_m = report::MeanAndDeviation{0.003, 0.001};
  summary.navigation_velocity_error_mps = report::MeanAndDeviation{1e-5, 2e-6};
  summary.samples = {{.time_h = 39.5, .nees = 5.5, .nees_dimension = 6.0}, {.time_h = 40.0}};
  summary.sources = {{.name = "servicer/gnss", .kind = "digital", .epochs = 12, .last_failure = "", .latest_s = 0.5}};
  summary.sensor_figures["gnss"]["time_to_20_mm_s"] = 120.0;
  summary.dv_mps = 0.25;
  return summary;
}

Numbers numbers() {
  report::WaypointRow waypoint;
  waypoint.index = 10;
  waypoint.navigation_error_m = 0.004;
  return numbers_of(Json::parse(report::summary_json(summary(), {waypoint})));
}

TEST(SummaryNumbers, StandUnderWhatIdentifiesThem) {
  const Numbers all = numbers();
  EXPECT_EQ(find_number(all, "waypoints.10.navigation_error_m"), 0.004);
  EXPECT_EQ(find_number(all, "navigation_error_mean_m"), 0.003);
  EXPECT_EQ(find_number(all, "navigation_error_std_m"), 0.001);
  EXPECT_EQ(find_number(all, "navigation_velocity_error_mean_mps"), 1e-5);
  EXPECT_EQ(find_number(all, "samples.39.5h.nees"), 5.5);
  EXPECT_EQ(find_number(all, "samples.39.5h.nees_dimension"), 6.0);
  EXPECT_EQ(find_number(all, "sources.servicer/gnss.epochs"), 12.0);
  EXPECT_EQ(find_number(all, "sensor_figures.gnss.time_to_20_mm_s"), 120.0);
  EXPECT_EQ(find_number(all, "dv_mps"), 0.25);
}

TEST(SummaryNumbers, HoldNothingOfTheWallClockAndNothingThatIsMissing) {
  const Numbers all = numbers();
  for (const char* key : {"wall_s", "speed_factor", "wall_share.truth_s", "sources.servicer/gnss.latest_s",
                          "samples.40h.nees", "first_fix_s", "schema", "seed"})
    EXPECT_FALSE(find_number(all, key)) << key;
}

TEST(Criteria, AreNotMetByANumberThatIsMissing) {
  Plan plan;
  plan.passes = {{"dv_mps", 0.3, 0.2}, {"first_fix_s", 100.0, std::nullopt}};
  Result result;
  result.numbers = numbers();
  EXPECT_THAT(failed_limits(plan, result), ElementsAre("first_fix_s"));
  EXPECT_FALSE(has_passed(plan, result));
  plan.passes = {{"dv_mps", 0.25, 0.25}};
  EXPECT_THAT(failed_limits(plan, result), IsEmpty());
  EXPECT_TRUE(has_passed(plan, result));
  result.state = State::kVoid;
  EXPECT_FALSE(has_passed(plan, result));
}

// Clopper and Pearson (1934), 95 % two-sided, as in published tables.
TEST(Requirement, IsJudgedByTheLowerClopperPearsonBound) {
  EXPECT_NEAR(100.0 * campaign_report::pass_rate(20, 20, 0.95).lower, 83.16, 0.005);
  EXPECT_NEAR(100.0 * campaign_report::pass_rate(99, 100, 0.95).lower, 94.55, 0.005);
  EXPECT_NEAR(100.0 * campaign_report::pass_rate(997, 1000, 0.95).lower, 99.13, 0.005);
  EXPECT_EQ(campaign_report::pass_rate(0, 10, 0.95).lower, 0.0);
  EXPECT_TRUE(judge({0.83, 0.95}, 20, 20, true).met);
  EXPECT_FALSE(judge({0.84, 0.95}, 20, 20, true).met);
  EXPECT_FALSE(judge({0.5, 0.95}, 20, 20, false).met) << "of a Latin hypercube no bound is known";
}

}  // namespace
}  // namespace vbar::campaign
