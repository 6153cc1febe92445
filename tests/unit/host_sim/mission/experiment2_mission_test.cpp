// missions/experiment2.toml flies the paper's waypoints 8 to 10 by the poses of a tumbling target, explains every key
// of navigation by poses, and the values it shows are the defaults that it says they are.

#include <algorithm>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/navigation_telecommands.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/mission/mission_text.h"
#include "tests/unit/host_sim/mission/shown_keys.h"

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
}  // namespace vbar::mission::test
