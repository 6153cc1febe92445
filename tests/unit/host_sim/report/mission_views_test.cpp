#include "host_sim/report/mission_views.h"

#include <gtest/gtest.h>

#include "tests/unit/host_sim/report/synthetic_run.h"

namespace vbar::report::test {
namespace {

// The paper calls waypoints 0 to 4 far range, 5 to 7 mid range and 8 to 10 close range.
TEST(MissionViews, SplitThePapersMissionAsThePaperDoes) {
  const std::vector<View> views = mission_views(synthetic_run());
  ASSERT_EQ(views.size(), 3U);
  EXPECT_EQ(views[0].name, "waypoints 0 to 4");
  EXPECT_EQ(views[1].name, "waypoints 4 to 8");
  EXPECT_EQ(views[2].name, "waypoints 8 to 10");
  EXPECT_EQ(views[0].start_s, 0.0);
  EXPECT_EQ(views[1].start_s, views[0].end_s);
  EXPECT_EQ(views[2].start_s, 39.0 * 3600.0);
  EXPECT_EQ(views[2].end_s, 41.25 * 3600.0);
}

TEST(MissionViews, CloseRangeAloneIsOneView) {
  RunRecord record = synthetic_run();
  record.waypoints.erase(record.waypoints.begin(), record.waypoints.begin() + 8);
  const std::vector<View> views = mission_views(record);
  ASSERT_EQ(views.size(), 1U);
  EXPECT_EQ(views.front().waypoints.size(), 3U);
}

TEST(MissionViews, ARunWithoutWaypointsIsSeenWhole) {
  RunRecord record = synthetic_run();
  record.waypoints.clear();
  const std::vector<View> views = mission_views(record);
  ASSERT_EQ(views.size(), 1U);
  EXPECT_EQ(views.front().name, "whole run");
  EXPECT_EQ(views.front().end_s, record.truth.back().time_s);
}

TEST(MissionViews, ARunWithoutAnyStepHasAView) {
  EXPECT_EQ(mission_views({}).size(), 1U);
}

}  // namespace
}  // namespace vbar::report::test
