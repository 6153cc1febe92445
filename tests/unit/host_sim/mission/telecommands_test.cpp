#include "host_sim/mission/telecommands.h"

#include <array>

#include <gtest/gtest.h>

#include "fsw/packets/messages.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {
namespace {

TEST(Telecommands, WaypointTableCarriesTheMissionsWaypoints) {
  const Mission mission = small_mission({"waypoint.1.solver=koenig_damico"});
  const vbar::waypoint_table table = waypoint_table_of(mission);
  ASSERT_EQ(table.count, 2);
  EXPECT_DOUBLE_EQ(table.reference_semi_major_axis_m, 7078138.944);
  EXPECT_EQ(table.waypoints[1].index, 1);
  EXPECT_EQ(table.waypoints[1].control_mode, 1);
  EXPECT_EQ(table.waypoints[1].gps_time_ns, mission.epoch.ns + 7200 * std::int64_t{1000000000});
  EXPECT_EQ(table.waypoints[1].a_roe_m[1], -600.0);
  EXPECT_EQ(table.waypoints[1].a_roe_m[5], 18.0);
}

TEST(Telecommands, ConfigurationIsInTheUnitsOfThePacketContract) {
  const Mission mission = small_mission(
      {"mission.start_h=1", "guidance.planner_delay_s=1200", "guidance.dv_min_mmps=0.25", "guidance.dv_max_mps=3",
       "guidance.compute_latency_s=1.5", "guidance.closed_form_period_s=301", "guidance.koenig_damico_period_s=61",
       "guidance.koenig_damico_grid_s=31", "guidance.roe_error_threshold_m=0.4", "guidance.keep_out_radius_m=0.6",
       "guidance.safety_horizon_s=6001", "guidance.station_keeping_deadband_m=0.7",
       "guidance.closed_form_tolerance_m=0.8", "guidance.koenig_damico_tolerance_m=0.009",
       "guidance.station_keeping_horizon_s=6003", "guidance.navigation_timeout_s=602"});
  const vbar::gnc_configuration configuration = mission.guidance.configuration;
  constexpr std::int64_t kSecond = 1000000000;
  EXPECT_EQ(configuration.compute_latency_ns, 3 * kSecond / 2);
  EXPECT_EQ(configuration.closed_form_period_ns, 301 * kSecond);
  EXPECT_EQ(configuration.koenig_damico_period_ns, 61 * kSecond);
  EXPECT_EQ(configuration.koenig_damico_grid_ns, 31 * kSecond);
  EXPECT_EQ(configuration.planner_start_ns, mission.epoch.ns + (3600 + 1200) * kSecond);
  EXPECT_DOUBLE_EQ(configuration.minimum_dv, 0.25e-3);
  EXPECT_EQ(configuration.maximum_dv, 3.0);
  EXPECT_EQ(configuration.roe_error_threshold_m, 0.4);
  EXPECT_EQ(configuration.keep_out_radius_m, 0.6);
  EXPECT_EQ(configuration.safety_horizon_s, 6001.0);
  EXPECT_EQ(configuration.station_keeping_deadband_m, 0.7);
  EXPECT_EQ(configuration.closed_form_tolerance_m, 0.8);
  EXPECT_EQ(configuration.koenig_damico_tolerance_m, 0.009);
  EXPECT_EQ(configuration.station_keeping_horizon_s, 6003.0);
  EXPECT_EQ(configuration.navigation_timeout_s, 602.0);
}

TEST(Telecommands, ModeIsTheContractsNumber) {
  EXPECT_EQ(mode_command_of(small_mission()).mode, 1);
  EXPECT_EQ(mode_command_of(small_mission({"guidance.mode=hold"})).mode, 3);
}

TEST(Telecommands, ArePackets) {
  const Mission mission = small_mission();
  std::array<std::uint8_t, fsw::packets::kMaxPacketBytes> buffer{};
  EXPECT_TRUE(fsw::packets::encode({}, waypoint_table_of(mission), buffer).ok());
  EXPECT_TRUE(fsw::packets::encode({}, mission.guidance.configuration, buffer).ok());
  EXPECT_TRUE(fsw::packets::encode({}, mode_command_of(mission), buffer).ok());
}

}  // namespace
}  // namespace vbar::mission::test
