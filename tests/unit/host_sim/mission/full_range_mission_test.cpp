// missions/full_range.toml flies all waypoints of the paper in one run, with two cameras.

#include <gtest/gtest.h>

#include "host_sim/sensors/camera/camera_kind.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {
namespace {

const Mission& full_range() {
  static const Mission loaded = load_mission(vbar::tests::source_path("missions/full_range.toml"));
  return loaded;
}

// Its waypoints are those of the three experiments.
TEST(FullRangeMission, WaypointsAreThoseOfIdealNavigation) {
  const Mission paper = load_mission(vbar::tests::source_path("missions/ideal_navigation.toml"));
  ASSERT_EQ(full_range().waypoints.size(), 11U);
  ASSERT_EQ(paper.waypoints.size(), 11U);
  for (std::size_t k = 0; k < 11; ++k) {
    EXPECT_EQ(full_range().waypoints[k].index, paper.waypoints[k].index);
    EXPECT_EQ(full_range().waypoints[k].time - full_range().epoch, paper.waypoints[k].time - paper.epoch) << k;
    EXPECT_EQ(full_range().waypoints[k].a_roe_m, paper.waypoints[k].a_roe_m) << k;
    EXPECT_EQ(full_range().waypoints[k].solver, paper.waypoints[k].solver) << k;
  }
  EXPECT_EQ(full_range().end_time(), full_range().waypoints.back().time);
}

TEST(FullRangeMission, OneCameraChangesItsUse) {
  const Spacecraft& servicer = *full_range().find_spacecraft("servicer");
  const auto* const far = sensors::navigation_camera(servicer, 0);
  const auto* const close = sensors::navigation_camera(servicer, 1);
  ASSERT_NE(far, nullptr);
  ASSERT_NE(close, nullptr);
  EXPECT_TRUE(far->changes_use());
  EXPECT_EQ(close->navigation, sensors::CameraSensor::kKeypoints);
  EXPECT_EQ(far->settings.optics.focal_length_mm, 35.0);
  EXPECT_EQ(close->settings.optics.focal_length_mm, 17.0);
  EXPECT_LT(far->keypoint_exposure_s, 50e-6);
}

TEST(FullRangeMission, StepsBecomeShorterOnTheWay) {
  const auto& parts = full_range().step.parts();
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(parts[0].period, fsw::duration_of_seconds(60));
  EXPECT_EQ(parts[2].period, fsw::duration_of_seconds(5));
}

}  // namespace
}  // namespace vbar::mission::test
