// missions/experiment2.toml flies the paper's waypoints 8 to 10 by the poses of a tumbling target, explains every key
// of navigation by poses, and the values it shows are the defaults that it says they are.

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/grand/grand_run.h"
#include "host_sim/installation/navigation_telecommands.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/gnss/gnss_kind.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {

namespace {

const std::string kExperiment2File = vbar::tests::source_path("missions/experiment2.toml");

TEST(Experiment2Mission, WaypointsAreThePapers) {
  // Table "End-to-end Mission ROE Waypoints".
  const Mission mission = load_mission(kExperiment2File);
  constexpr double kPaper[3][7] = {{39.0, -0.5, -10.0, 0.0, 2.0, 0.0, 1.0},
                                   {40.0, 0.0, -7.0, 1.0, 0.0, 2.0, 0.0},
                                   {41.25, 0.0, -8.5, 1.0, 0.0, 1.0, 0.0}};
  ASSERT_EQ(mission.waypoints.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(mission.waypoints[k].index, 8 + static_cast<int>(k));
    EXPECT_EQ((mission.waypoints[k].time - mission.epoch).ns, static_cast<std::int64_t>(kPaper[k][0] * 3600e9));
    for (int i = 0; i < 6; ++i) EXPECT_EQ(mission.waypoints[k].a_roe_m(i), kPaper[k][i + 1]) << k << ' ' << i;
    EXPECT_EQ(mission.waypoints[k].solver, Solver{waypoint::kSolverKoenigDamico});
  }
  EXPECT_EQ(mission.start_time(), mission.waypoints.front().time);
  EXPECT_EQ(mission.end_time(), mission.waypoints.back().time);
}

TEST(Experiment2Mission, EveryKeyOfNavigationByPosesIsExplained) {
  expect_all_shown(text_of_file(kExperiment2File), kExperiment2File, {"navigation.pose", "navigation.apriori"});
}

/// What flight software is telecommanded about the camera by a mission file of this text.
std::vector<twins::Packet> telecommand(const std::string& text) {
  static const auto orientation =
      truth::EarthOrientationSeries::load(vbar::tests::source_path("data/earth/eop_2009_2013.csv"));
  const Mission mission = parse_mission(text, kExperiment2File);
  const Spacecraft& servicer = *mission.find_spacecraft("servicer");
  const fsw::orbit::CartesianState own{{7.0e6, 0.0, 0.0}, {0.0, 100.0, 7546.0}};
  const fsw::orbit::CartesianState target{own.position_eci + fsw::Vector3(1.0, 8.0, 3.0), own.velocity_eci};
  sensors::Telecommands telecommands(mission.start_time(), servicer.number);
  const auto camera = std::ranges::find(servicer.sensors, "camera", &Sensor::kind);
  EXPECT_NE(camera, servicer.sensors.end());
  const sensors::TelecommandContext context{
      mission, servicer, vbar::tests::source_path("data"), orientation,
      [&](std::string_view spacecraft) { return spacecraft == "servicer" ? own : target; }};
  sensors::add_navigation_telecommands(context, telecommands);
  sensors::add_camera_telecommands(*camera, context, telecommands);
  return telecommands.packets();
}

/// Lines of the sections that explain the keys, by key: where each begins, and the default that its comment names, if
/// any.
struct ShownKey {
  std::size_t begin = 0, end = 0;
  std::string value, other_default;
};
std::map<std::string, ShownKey> shown_keys(const std::string& text) {
  std::map<std::string, ShownKey> keys;
  bool is_of_navigation = false;
  for (std::size_t begin = 0, end = 0; begin < text.size(); begin = end + 1) {
    end = text.find('\n', begin);
    const std::string line = text.substr(begin, end - begin);
    if (line.starts_with('[')) is_of_navigation = line.starts_with("[navigation");
    const std::size_t equals = line.find(" = ");
    if (!is_of_navigation || line.starts_with('#') || equals == std::string::npos) continue;
    const std::size_t comment = line.find('#'), other = line.find("default ");
    const std::string value = line.substr(equals + 3, line.find(' ', equals + 3) - equals - 3);
    keys[line.substr(0, equals) + "@" + std::to_string(begin)] = {
        begin, end, value,
        comment < other && other != std::string::npos ? line.substr(other + std::strlen("default ")) : ""};
  }
  return keys;
}

// A key left out has the value that the file shows, or the one that it says is the default.
TEST(Experiment2Mission, ShowsTheDefaults) {
  const std::string text = text_of_file(kExperiment2File);
  const std::map<std::string, ShownKey> keys = shown_keys(text);
  ASSERT_GE(keys.size(), 16U);
  int others = 0;
  for (const auto& [key, shown] : keys) {
    SCOPED_TRACE(key);
    std::string without = text, with_default = text;
    without.replace(without.begin() + static_cast<std::ptrdiff_t>(shown.begin),
                    without.begin() + static_cast<std::ptrdiff_t>(shown.end), "");
    if (!shown.other_default.empty()) {
      ++others;
      with_default.replace(with_default.find(" = ", shown.begin) + 3, shown.value.size(), shown.other_default);
      EXPECT_NE(telecommand(without), telecommand(text)) << "the default is what is shown";
    }
    EXPECT_EQ(telecommand(without), telecommand(with_default));
  }
  EXPECT_EQ(others, 3) << "acceleration_psd, its minimum, maneuver_sigma_percent";
}

TEST(Experiment2Mission, FliesByTheCameraOfTheTestbed) {
  const Mission mission = load_mission(kExperiment2File);
  const Spacecraft& servicer = *mission.find_spacecraft("servicer");
  const auto* const camera = find_settings<sensors::CameraSensor>(servicer);
  ASSERT_NE(camera, nullptr);
  EXPECT_EQ(camera->navigation, sensors::CameraSensor::kKeypoints);
  EXPECT_EQ(camera->camera, "tron");
  EXPECT_TRUE(std::holds_alternative<Tumble>(*mission.find_spacecraft("target")->attitude));
  EXPECT_FALSE(mission.find_spacecraft("target")->flight_computer.has_value()) << "it does not cooperate";
}

TEST(Experiment2Mission, AsPrintedDiffersInTheNodeOnly) {
  const Mission mission = load_mission(kExperiment2File),
                printed = load_mission(vbar::tests::source_path("missions/experiment2_as_printed.toml"));
  fsw::orbit::QnsElements as_printed = std::get<OrbitByElements>(printed.find_spacecraft("servicer")->orbit).elements;
  const fsw::orbit::QnsElements& flown = std::get<OrbitByElements>(mission.find_spacecraft("servicer")->orbit).elements;
  EXPECT_DOUBLE_EQ(as_printed.raan, -1.5707963267948966);
  EXPECT_EQ(as_printed.a, flown.a);
  EXPECT_EQ(as_printed.i, flown.i);
  EXPECT_EQ(as_printed.u, flown.u);
  EXPECT_EQ(printed.name, "experiment2_as_printed");
  EXPECT_EQ(printed.waypoints.size(), mission.waypoints.size());
  EXPECT_EQ(printed.end_time(), mission.end_time());
}

}  // namespace

// missions/experiment3.toml flies the paper's waypoints 8 to 10, explains every key of GNSS, and the values it shows
// are the defaults that it says they are.

namespace {

const std::string kExperiment3File = vbar::tests::source_path("missions/experiment3.toml");
const std::string kGrand = vbar::tests::source_path("missions/experiment3_grand.toml");

TEST(Experiment3Mission, WaypointsAreThePapers) {
  // Table "End-to-end Mission ROE Waypoints".
  const Mission mission = load_mission(kExperiment3File);
  constexpr double kPaper[3][7] = {{39.0, -0.5, -10.0, 0.0, 2.0, 0.0, 1.0},
                                   {40.0, 0.0, -7.0, 1.0, 0.0, 2.0, 0.0},
                                   {41.25, 0.0, -8.5, 1.0, 0.0, 1.0, 0.0}};
  ASSERT_EQ(mission.waypoints.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(mission.waypoints[k].index, 8 + static_cast<int>(k));
    EXPECT_EQ((mission.waypoints[k].time - mission.epoch).ns, static_cast<std::int64_t>(kPaper[k][0] * 3600e9));
    for (int i = 0; i < 6; ++i) EXPECT_EQ(mission.waypoints[k].a_roe_m(i), kPaper[k][i + 1]) << k << ' ' << i;
    EXPECT_EQ(mission.waypoints[k].solver, Solver{waypoint::kSolverKoenigDamico});
  }
  // "the maneuver planner was initiated at t = 20 minutes"
  EXPECT_EQ(mission.guidance.configuration.planner_start_ns,
            (mission.start_time() + fsw::duration_of_seconds(1200)).ns);
}

TEST(Experiment3Mission, EveryKeyOfGnssIsExplained) {
  const std::string sensor = "spacecraft.servicer.sensors.gnss";
  // The keys of a receiver in a testbed are explained in the mission that has one.
  expect_all_shown(
      text_of_file(kExperiment3File) + text_of_file(kGrand), kExperiment3File,
      {sensor, sensor + ".visibility", sensor + ".link_budget", sensor + ".tracking", sensor + ".start",
       sensor + ".clock", sensor + ".body_frame", "navigation.carrier_phase", "constellation", "links.crosslink"});
}

// A mission without the tables has the same values, but for the loss of the crosslink, of which the file says so.
TEST(Experiment3Mission, ShowsTheDefaults) {
  const Mission shown = load_mission(kExperiment3File);
  const twins::gnss::GnssReceiverSettings defaults;
  EXPECT_TRUE(sensor_of<GnssSensor>(shown).receiver == defaults);
  EXPECT_TRUE(sensor_of<GnssSensor>(shown, "target").receiver == defaults);

  const Mission bare = small_mission();
  const auto &tables = shared_settings<GnssShared>(shown), &defaults_of_tables = shared_settings<GnssShared>(bare);
  EXPECT_TRUE(tables.constellation == defaults_of_tables.constellation);
  EXPECT_EQ(packet_of(tables.carrier), packet_of(defaults_of_tables.carrier));
  EXPECT_EQ(packet_of(shown.navigation.configuration), packet_of(bare.navigation.configuration));
  EXPECT_EQ(packet_of(shown.navigation.thruster), packet_of(bare.navigation.thruster));
  EXPECT_EQ(defaults_of_tables.crosslink.link.loss_probability, 0.0);
  twins::gnss::CrosslinkSettings without_loss = tables.crosslink;
  without_loss.link.loss_probability = 0.0;
  EXPECT_TRUE(without_loss == defaults_of_tables.crosslink);
  EXPECT_TRUE(bare.burns.empty());
}

// Appendix A: "GNSS Software Emulator" and "body-frame" tables.
TEST(Experiment3Mission, ReceiverIsThePapers) {
  const twins::gnss::GnssReceiverSettings receiver = sensor_of<GnssSensor>(load_mission(kExperiment3File)).receiver;
  EXPECT_EQ(receiver.visibility.transmit_aperture_deg, 170.0);
  EXPECT_EQ(receiver.visibility.receiver_mask_deg, 190.0);
  EXPECT_EQ(receiver.visibility.horizon_mask_deg, -20.0);
  EXPECT_EQ(receiver.link_budget.lna_gain_db, 33.0);
  EXPECT_EQ(load_mission(kExperiment3File).find_spacecraft("servicer")->mass_sigma_kg, 0.04);
  EXPECT_EQ(receiver.body_frame.com_radius_mm, 3.0);
  EXPECT_EQ(receiver.body_frame.pco_bias_mm, 5.0);
  EXPECT_EQ(receiver.body_frame.pco_noise_mm, 1.0);
  EXPECT_EQ(receiver.body_frame.antenna_direction_arcsec, 30.0);
  EXPECT_EQ(receiver.body_frame.attitude_knowledge_arcsec, 20.0);
}

TEST(GnssNavigationOnlyMission, IsIdleWithBurns) {
  const Mission mission = load_mission(vbar::tests::source_path("missions/gnss_navigation_only.toml"));
  EXPECT_EQ(mission.guidance.mode, Mode::kIdle);
  EXPECT_EQ(mission.burns.size(), 4U);
  EXPECT_NE(find_settings<GnssSensor>(*mission.find_spacecraft("servicer")), nullptr);
}

}  // namespace

// missions/experiment3_grand.toml explains every key of the GNSS testbed, the values it shows are the defaults, and
// combinations of keys that contradict each other are refused by one sentence.

namespace {

using grand::GrandSettings;
using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kExperiment3GrandFile = vbar::tests::source_path("missions/experiment3_grand.toml");
const std::string kLive = vbar::tests::source_path("missions/experiment3_grand_live.toml");

const GrandSettings& grand_of(const Mission& mission) {
  return dynamic_cast<const GrandSettings&>(*mission.testbeds.at(0).settings);
}

std::string refusal(const std::vector<std::string>& overrides, const std::string& file = kExperiment3GrandFile) {
  try {
    static_cast<void>(sensors::load_mission(file, overrides));
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(Experiment3GrandMission, EveryKeyOfTheTestbedIsExplained) {
  const std::string text = text_of_file(kExperiment3GrandFile);
  expect_all_shown(text, kExperiment3GrandFile, {"testbed.grand", "testbed.grand.skydel"});
}

TEST(Experiment3GrandMission, ShowsTheDefaults) {
  const Mission shown = sensors::load_mission(kExperiment3GrandFile);
  const Mission bare = sensors::parse_mission("extends = \"" + vbar::tests::source_path("missions/experiment3.toml") +
                                                  "\"\n[testbed.grand]\nbench = \"a bench\"\n",
                                              "bare.toml");
  const GrandSettings &a = grand_of(shown), &b = grand_of(bare);
  EXPECT_EQ(a.generator, b.generator);
  EXPECT_EQ(a.host, b.host);
  EXPECT_EQ(a.control_port, b.control_port);
  EXPECT_EQ(a.hil_port, b.hil_port);
  EXPECT_EQ(a.sample_period, b.sample_period);
  EXPECT_EQ(a.lead, b.lead);
  EXPECT_EQ(a.join, b.join);
  EXPECT_EQ(a.pace, b.pace);
  EXPECT_EQ(a.pps, b.pps);
  EXPECT_EQ(a.chrony, b.chrony);
  EXPECT_EQ(a.give_up, b.give_up);
  EXPECT_EQ(a.week_shift, b.week_shift);
  EXPECT_EQ(a.sample_period.ns, 100'000'000);  // the paper: 10 Hz
  const auto &line = sensor_of<sensors::GnssSensor>(shown).line, &other = sensor_of<sensors::GnssSensor>(bare).line;
  EXPECT_EQ(line.port, other.port);
  EXPECT_EQ(line.baud, other.baud);
  EXPECT_EQ(line.wired, other.wired);
  EXPECT_EQ(line.log_offset_s, other.log_offset_s);
  EXPECT_EQ(line.clock_adjust, other.clock_adjust);
  EXPECT_EQ(line.max_latency_s, other.max_latency_s);
}

TEST(Experiment3GrandMission, LiveFollowsTheWallClock) {
  const Mission live = sensors::load_mission(kLive);
  EXPECT_EQ(live.clock.mode, engine::ClockMode::kRealTime);
  EXPECT_EQ(live.clock.speed_factor, 1.0);
  EXPECT_EQ(live.duration, fsw::duration_of_seconds(120));
  EXPECT_EQ(grand_of(live).pace, grand::Pace::kRealTime);
  EXPECT_EQ(sensors::load_mission(kExperiment3GrandFile).clock.mode, engine::ClockMode::kLockStep);
}

TEST(Experiment3GrandMission, GnssSdrReceivesForTenMinutesInRealTime) {
  const Mission mission = sensors::load_mission(vbar::tests::source_path("missions/experiment3_grand_gnss_sdr.toml"));
  EXPECT_EQ(mission.clock.mode, engine::ClockMode::kRealTime);
  EXPECT_EQ(mission.duration, fsw::duration_of_seconds(600));
  EXPECT_THAT(grand_of(mission).bench, HasSubstr("--pace real_time --receiver gnss_sdr"));
  for (const char* const spacecraft : {"servicer", "target"}) {
    const auto& line = sensor_of<sensors::GnssSensor>(mission, spacecraft).line;
    EXPECT_EQ(line.log_offset_s, 8.0);
    EXPECT_EQ(line.max_latency_s, 1.95);
  }
}

// A run of minutes ends before its first waypoint, by whose errors others are judged.
TEST(EmulatedBenchMissions, StateLimitsOfTheirOwn) {
  int benches = 0;
  for (const auto& entry : std::filesystem::directory_iterator(vbar::tests::source_path("missions"))) {
    if (entry.path().extension() != ".toml") continue;
    const Mission mission = sensors::load_mission(entry.path());
    const bool is_bench =
        std::ranges::any_of(mission.testbeds, [](const Testbed& one) { return one.name != "external"; });
    benches += is_bench ? 1 : 0;
    EXPECT_EQ(is_bench && mission.limits.empty(), false) << entry.path();
  }
  EXPECT_GE(benches, 5);
}

TEST(Experiment3GrandMission, ContradictionsAreRefused) {
  EXPECT_THAT(refusal({"clock.mode=\"real_time\""}), AllOf(HasSubstr("clock.mode"), HasSubstr("testbed.grand.pace")));
  EXPECT_THAT(refusal({"clock.mode=\"lock_step\""}, kLive), HasSubstr("testbed.grand.pace"));
  EXPECT_THAT(refusal({"clock.speed_factor=2.0"}, kLive), HasSubstr("speed_factor"));
  EXPECT_THAT(refusal({"testbed.grand.lead_ms=20.0"}), AllOf(HasSubstr("lead_ms"), HasSubstr("lock_step")));
  EXPECT_THAT(refusal({"testbed.grand.pps=\"timer\""}), AllOf(HasSubstr("pps"), HasSubstr("lock_step")));
  EXPECT_THAT(refusal({"testbed.grand.pps=\"kernel\""}, kLive), HasSubstr("kernel:DEVICE"));
  EXPECT_THAT(refusal({"testbed.grand.rate_hz=3"}), HasSubstr("1, 2, 4, 5, 10, 20, 25 or 50"));
  EXPECT_THAT(refusal({"testbed.grand.generator=\"ifen\""}), AllOf(HasSubstr("skydel"), HasSubstr("template")));
  EXPECT_THAT(refusal({"spacecraft.servicer.sensors.gnss.max_latency_s=0.0"}), HasSubstr("max_latency_s"));
  EXPECT_THAT(refusal({"testbed.grand.bench=\"\""}), HasSubstr("control_port"));
  EXPECT_THAT(refusal({"spacecraft.target.sensors.gnss.source=\"digital\""}),
              AllOf(HasSubstr("source"), HasSubstr("target"), HasSubstr("sky")));
  EXPECT_THAT(refusal({"spacecraft.servicer.sensors.gnss.source=\"digital\""}), HasSubstr("source"));
  EXPECT_THAT(refusal({"spacecraft.target.sensors.gnss.wired=\"board\""}),
              AllOf(HasSubstr("wired"), HasSubstr("target has no flight computer")));
}

}  // namespace

}  // namespace vbar::mission::test
