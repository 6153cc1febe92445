// [[fault]]: what is read, and what the mission cannot apply.

#include <array>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fsw/packets/messages.h"
#include "host_sim/mission/mission.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {

namespace {

const std::string kBase(kSmallMission);

std::string with_fault(const std::string& keys) {
  return kBase + "[[fault]]\n" + keys;
}

Mission mission_with(const std::string& keys) {
  return parse_mission(with_fault(keys), "m.toml", {});
}

TEST(FaultKeys, AreReadWithTheirUnits) {
  const Mission mission = mission_with(
      "kind = \"thrust_uncommanded\"\nat_h = 0.5\nfor_s = 10.0\nvalue_mps2 = 1e-3\ndirection_rtn = [0.0, 0.5, 0.0]\n");
  ASSERT_EQ(mission.faults.size(), 1U);
  const Fault& fault = mission.faults[0];
  EXPECT_EQ(fault.kind, FaultKind::kThrustUncommanded);
  EXPECT_EQ(fault.name, "thrust_uncommanded");
  EXPECT_EQ(fsw::seconds(fault.begin - mission.epoch), 1800.0);
  EXPECT_EQ(fsw::seconds(*fault.duration), 10.0);
  EXPECT_EQ(fault.direction_rtn.y(), 1.0);
  EXPECT_TRUE(fault.is_reported);
  EXPECT_FALSE(fault.is_present(fault.begin - fsw::Duration{1}));
  EXPECT_TRUE(fault.is_present(fault.begin));
  EXPECT_FALSE(fault.is_present(fault.begin + *fault.duration));
}

TEST(FaultKeys, ASensorIsNamedByItsSpacecraftAndItself) {
  const Fault fault = mission_with("kind = \"silent\"\nunit = \"navigation\"\nat_h = 0.5\n").faults[0];
  EXPECT_EQ(fault.spacecraft, "servicer");
  EXPECT_EQ(fault.unit, "navigation");
  EXPECT_FALSE(fault.duration.has_value());
}

TEST(FaultKeys, ARebootKeepsItsStateOnEveryTargetButNotThatOfALibrary) {
  const std::string reboot = "kind = \"computer_reboot\"\nat_h = 0.5\nfor_s = 60.0\nkeeps_state = true\n";
  EXPECT_TRUE(mission_with(reboot).faults[0].keeps_state);
  const auto on = [&](const std::string& computer) {
    return changed(with_fault(reboot), "flight_computer = {}", "flight_computer = { " + computer + " }");
  };
  EXPECT_TRUE(parse_mission(on("target = \"zynq_qemu\""), "m.toml").faults[0].keeps_state);
  const std::string message = message_of(on("library = \"x.so\""));
  EXPECT_NE(message.find("fault.0.keeps_state: found true; accepted: false, or no flight_computer.library"),
            std::string::npos)
      << message;
}

// Both spacecraft with a receiver.
std::string with_receivers(const std::string& keys) {
  std::string text = changed(with_fault(keys), "sensors.navigation = {}",
                             "sensors.gnss = { partner = \"target\" }\nattitude = { profile = \"zenith\" }");
  return changed(text, "body = \"tango\"", "body = \"tango\"\nattitude = { profile = \"zenith\" }\nsensors.gnss = {}");
}

TEST(FaultKeys, AFaultBeginsWithAnEventInPlaceOfATime) {
  const std::string slip = "kind = \"cycle_slip\"\nunit = \"gnss\"\nvalue_cycles = -2\n";
  const auto start_of = [&](const std::string& event) {
    return parse_mission(with_receivers(slip + event), "m.toml", {}).faults[0];
  };
  const Fault fix = start_of("event = \"first_fix\"\nafter_s = 600.0\n");
  ASSERT_TRUE(fix.awaited.has_value());
  EXPECT_EQ(fix.awaited->kind, FaultEvent::Kind::kFirstFix);
  EXPECT_EQ(fix.awaited->delay, fsw::duration_of_seconds(600));
  EXPECT_FALSE(fix.has_begun(Fault::kNever));
  EXPECT_EQ(fix.value, -2.0);
  EXPECT_EQ(fix.satellite, "highest");
  EXPECT_FALSE(fix.is_present(fix.begin)) << "an instant";
  const Fault range = start_of("event = \"range_below_m:12.5\"\n");
  EXPECT_EQ(range.awaited->kind, FaultEvent::Kind::kRangeBelow);
  EXPECT_EQ(range.awaited->argument, 12.5);
  EXPECT_EQ(start_of("event = \"burn:3\"\n").awaited->argument, 3.0);
  const Mission mission =
      mission_with("kind = \"thrust_scale\"\nvalue = 0.5\nevent = \"waypoint:0\"\nafter_s = 60.0\n");
  EXPECT_EQ(mission.faults[0].begin, mission.epoch + fsw::duration_of_seconds(60)) << "known beforehand";
  EXPECT_FALSE(mission.faults[0].awaited.has_value());
  EXPECT_EQ(mission.faults[0].start, "waypoint:0");
}

TEST(FaultKeys, ReceiversFailAsTheirTwinCan) {
  const Mission mission =
      parse_mission(with_receivers("kind = \"receiver_reset\"\nunit = \"gnss\"\nspacecraft = \"target\"\nat_h = 0.5\n"),
                    "m.toml", {});
  EXPECT_EQ(mission.faults[0].spacecraft, "target");
  EXPECT_EQ(*mission.faults[0].duration, fsw::Duration{0});
  const auto refused = [](const std::string& keys) { return message_of(with_receivers(keys)); };
  const std::string gnss = "unit = \"gnss\"\nat_h = 0.5\n";
  EXPECT_THAT(refused("kind = \"cycle_slip\"\nvalue_cycles = 0\n" + gnss),
              testing::EndsWith("an integer that is not 0"));
  EXPECT_THAT(refused("kind = \"cycle_slip\"\nvalue_cycles = 1\nfor_s = 1\n" + gnss),
              testing::EndsWith("it jumps once"));
  EXPECT_THAT(refused("kind = \"cycle_slip\"\nvalue_cycles = 1\nsatellite = \"X05\"\n" + gnss),
              testing::EndsWith("G05, E11, C03"));
  EXPECT_THAT(refused("kind = \"clock_jump\"\nvalue_s = 1e-7\n" + gnss), testing::EndsWith("of either sign"));
}

struct Refused {
  std::string keys;
  std::string message;  ///< the end of it
};

TEST(FaultKeys, WhatTheMissionCannotApplyIsRefused) {
  const Refused refused[] = {
      {"kind = \"silent\"\nunit = \"radar\"\nat_h = 0.5\n", "a sensor of servicer that can fail so: navigation"},
      {"kind = \"frozen\"\nunit = \"navigation\"\nat_h = 0.5\n", "can fail so: it has none"},
      {"kind = \"receiver_silent\"\nunit = \"navigation\"\nat_h = 0.5\n", "can fail so: it has none"},
      {"kind = \"target_hidden\"\nunit = \"navigation\"\nat_h = 0.5\n", "can fail so: it has none"},
      {"kind = \"target_turned\"\nunit = \"navigation\"\nat_h = 0.5\nvalue_deg = 90.0\n", "can fail so: it has none"},
      {"kind = \"silent\"\nunit = \"gnss\"\nspacecraft = \"moon\"\nat_h = 0.5\n",
       "accepted: servicer, or the spacecraft that it observes"},
      {"kind = \"silent\"\nunit = \"navigation\"\nat_h = 3.0\n", "accepted: a time of the run"},
      {"kind = \"silent\"\nunit = \"navigation\"\n", "accepted: a number from 0 to 2000"},
      {"kind = \"silent\"\nunit = \"navigation\"\nat_h = 0.5\nevent = \"burn:1\"\n",
       "accepted: at_h or event, not both"},
      {"kind = \"silent\"\nunit = \"navigation\"\nat_h = 0.5\nafter_s = 1.0\n",
       "event, at_h, for_s, spacecraft or unit"},
      {"kind = \"silent\"\nunit = \"navigation\"\nevent = \"first_fix\"\n", "that navigates by carrier phase"},
      {"kind = \"silent\"\nunit = \"navigation\"\nevent = \"waypoint:7\"\n", "accepted: a waypoint of the run"},
      {"kind = \"silent\"\nunit = \"navigation\"\nevent = \"burn:0\"\n", "or range_below_m:X with X above 0"},
      {"kind = \"silent\"\nunit = \"navigation\"\nevent = \"range_below_m:nan\"\n",
       "or range_below_m:X with X above 0"},
      {"kind = \"silent\"\nunit = \"navigation\"\nevent = \"first_fix:1\"\n", "or range_below_m:X with X above 0"},
      {"kind = \"receiver_reset\"\nunit = \"navigation\"\nat_h = 0.5\n", "can fail so: it has none"},
      {"kind = \"computer_silent\"\nat_h = 0.5\n", "accepted: the time until it returns"},
      {"kind = \"thrust_uncommanded\"\nat_h = 0.5\nvalue_mps2 = 1e-3\ndirection_rtn = [0, 1, 0]\n",
       "accepted: the time until its valve is closed"},
      {"kind = \"thrust_uncommanded\"\nat_h = 0.5\nfor_s = 1\nvalue_mps2 = 1e-3\ndirection_rtn = [0, 0, 0]\n",
       "accepted: a direction"},
      {"kind = \"thrust_scale\"\nat_h = 0.5\nvalue = -0.1\n", "accepted: a number from 0 to 10"},
      {"kind = \"thrust_scale\"\nat_h = 0.5\nvalue = 0.5\nunit = \"thruster\"\n",
       "accepted: kind, name, event, at_h, for_s, value or reported"},
  };
  for (const Refused& one : refused) {
    const std::string message = message_of(with_fault(one.keys));
    EXPECT_TRUE(message.starts_with("m.toml:") && message.ends_with(one.message)) << one.keys << message;
  }
}

}  // namespace

// [[limit]]: what is read, what is refused, and that nothing else of a mission is needed to read it.

namespace {

std::string with_limits(const std::string& tables) {
  return std::string(kSmallMission) + tables;
}

TEST(LimitKeys, AreReadInTheOrderOfTheFile) {
  const auto limits = parse_mission(with_limits("[[limit]]\nkey = \"dv_mps\"\nmost = 4.2\n"
                                                "[[limit]]\nkey = \"waypoints.10.nees\"\nleast = 0.5\nmost = 7.8\n"),
                                    "m.toml")
                          .limits;
  ASSERT_EQ(limits.size(), 2U);
  EXPECT_EQ(limits[0].key, "dv_mps");
  EXPECT_EQ(limits[0].most, 4.2);
  EXPECT_FALSE(limits[0].least);
  EXPECT_EQ(limits[1].least, 0.5);
  EXPECT_TRUE(parse_mission(std::string(kSmallMission), "m.toml").limits.empty());
}

TEST(LimitKeys, RefuseALimitThatCannotBeMetOrSaysNothing) {
  const auto refusal = [](const std::string& tables) { return message_of(with_limits(tables)); };
  EXPECT_THAT(refusal("[[limit]]\nkey = \"a\"\n"), testing::HasSubstr("neither most nor least"));
  EXPECT_THAT(refusal("[[limit]]\nmost = 1\n"), testing::HasSubstr("limit.0.key"));
  EXPECT_THAT(refusal("[[limit]]\nkey = \"a\"\nmost = 1\nleast = 2\n"), testing::HasSubstr("limit.0.least"));
  EXPECT_THAT(refusal("[[limit]]\nkey = \"a\"\nmost = nan\n"), testing::HasSubstr("limit.0.most"));
  EXPECT_THAT(refusal("[[limit]]\nkey = \"a\"\nmost = 1\nmax = 1\n"), testing::HasSubstr("max"));
  EXPECT_THAT(refusal("[[limit]]\nkey = \"a\"\nmost = 1\n[[limit]]\nkey = \"a\"\nleast = 0\n"),
              testing::HasSubstr("limit.1.key"));
}

TEST(LimitKeys, OfAFileAloneNeedNothingElseOfTheMission) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "vbar_limits_only.toml";
  std::ofstream(file) << "[[limit]]\nkey = \"dv_mps\"\nmost = 4.2\n";
  const std::array<std::string, 1> overrides{"limit=[{key=\"dv_mps\", most=1.0}]"};
  EXPECT_EQ(load_limits(file, {}).at(0).most, 4.2);
  EXPECT_EQ(load_limits(file, overrides).at(0).most, 1.0);
  std::filesystem::remove(file);
}

}  // namespace

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
