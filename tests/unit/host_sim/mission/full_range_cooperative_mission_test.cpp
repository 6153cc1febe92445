// missions/full_range_cooperative.toml: the whole mission to a target that cooperates from waypoint 4 on.

#include <gtest/gtest.h>

#include "host_sim/sensors/gnss/gnss_kind.h"
#include "host_sim/sensors/navigation_telecommands.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {
namespace {

const Mission& full_range_cooperative() {
  static const Mission loaded = load_mission(vbar::tests::source_path("missions/full_range_cooperative.toml"));
  return loaded;
}

TEST(FullRangeCooperativeMission, UsesAllSourcesFromTheFirstStepOn) {
  using Use = navigation_configuration;
  EXPECT_EQ(sensors::sources_of(*full_range_cooperative().find_spacecraft("servicer")),
            std::int32_t{Use::kUseOwnGnss} + std::int32_t{Use::kUseCarrierPair} + std::int32_t{Use::kUseBearings} +
                std::int32_t{Use::kUseKeypoints});
}

TEST(FullRangeCooperativeMission, TheTargetCooperatesFromWaypoint4On) {
  const fsw::Duration waypoint_4 = full_range_cooperative().waypoints[4].time - full_range_cooperative().epoch;
  const std::vector<LaterAttitude>& later = full_range_cooperative().find_spacecraft("target")->later_attitudes;
  ASSERT_EQ(later.size(), 1U);
  EXPECT_EQ(fsw::nearest_duration(later[0].from_s), waypoint_4);
  EXPECT_EQ(std::get<truth::PointedSettings>(later[0].profile).pointing.boresight_to, truth::Direction::kZenith);
  EXPECT_EQ(shared_settings<sensors::GnssShared>(full_range_cooperative()).crosslink_from, waypoint_4);
}

// What is not of the target is that of full_range.toml.
TEST(FullRangeCooperativeMission, IsOtherwiseTheWholeMission) {
  const Mission whole = load_mission(vbar::tests::source_path("missions/full_range.toml"));
  ASSERT_EQ(full_range_cooperative().waypoints.size(), whole.waypoints.size());
  for (std::size_t k = 0; k < whole.waypoints.size(); ++k) {
    EXPECT_EQ(full_range_cooperative().waypoints[k].a_roe_m, whole.waypoints[k].a_roe_m) << k;
    EXPECT_EQ(full_range_cooperative().waypoints[k].time, whole.waypoints[k].time) << k;
  }
  EXPECT_EQ(full_range_cooperative().end_time(), whole.end_time());
  EXPECT_EQ(full_range_cooperative().spacecraft.size(), whole.spacecraft.size());
}

// Retreat and guard are those of full_range_retreat.toml.
TEST(FullRangeCooperativeMission, HasAVariantWithARetreat) {
  const Mission retreat = load_mission(vbar::tests::source_path("missions/full_range_cooperative_retreat.toml"));
  const Mission alone = load_mission(vbar::tests::source_path("missions/full_range_retreat.toml"));
  EXPECT_FALSE(full_range_cooperative().safety.has_value());
  ASSERT_TRUE(retreat.safety.has_value());
  EXPECT_EQ(packet_of(*retreat.safety), packet_of(*alone.safety));
  EXPECT_EQ(packet_of(retreat.guidance.configuration), packet_of(alone.guidance.configuration));
  EXPECT_EQ(sensors::sources_of(*retreat.find_spacecraft("servicer")),
            sensors::sources_of(*full_range_cooperative().find_spacecraft("servicer")));
  for (std::size_t k = 0; k < retreat.waypoints.size(); ++k)
    EXPECT_EQ(retreat.waypoints[k].keep_out_radius_m, alone.waypoints[k].keep_out_radius_m) << k;
  EXPECT_EQ(retreat.waypoints[8].keep_out_radius_m, 0.8);
}

}  // namespace
}  // namespace vbar::mission::test
