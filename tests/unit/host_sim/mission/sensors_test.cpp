// Named sensors, testbeds and clock sources of a mission: what is accepted, and the one message that refuses the rest.

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

#include "tests/support/paths.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kSmall(kSmallMission);

/// The small mission with these sensors of the servicer, which has an attitude, and a target that cameras see.
std::string with_sensors(const std::string& sensors) {
  std::string text = changed(kSmall, "sensors.navigation = {}", "attitude = { profile = \"commanded\" }\n" + sensors);
  return changed(text, "relative = {", "model = \"tango\"\nattitude = { profile = \"tumble\" }\nrelative = {");
}

std::vector<std::string> names_of(const Mission& mission) {
  std::vector<std::string> names;
  for (const Sensor& sensor : mission.spacecraft[0].sensors) names.push_back(sensor.name + ":" + sensor.kind);
  return names;
}

TEST(Sensors, HaveNamesOfTheirOwn) {
  const Mission mission =
      parse_mission(with_sensors("sensors.wide = { kind = \"camera\", camera = \"tron\", period_s = 30 }\n"
                                 "sensors.narrow = { kind = \"camera\", navigation = \"none\" }\nsensors.gnss = {}"),
                    "m.toml");
  // A kind after the other, whatever the order in the file; the sensors of a kind by name.
  EXPECT_THAT(names_of(mission), ElementsAre("gnss:gnss", "narrow:camera", "wide:camera"));
  const auto& sensors = mission.spacecraft[0].sensors;
  EXPECT_EQ(sensors::settings_of<CameraSensor>(sensors[1]).camera, "optical_stimulator");
  EXPECT_FALSE(sensors::settings_of<CameraSensor>(sensors[1]).is_used());
  EXPECT_EQ(sensors::settings_of<CameraSensor>(sensors[2]).camera, "tron");
  EXPECT_EQ(sensors::settings_of<CameraSensor>(sensors[2]).images.shortest_period(), fsw::duration_of_seconds(30));
}

TEST(Sensors, BearingsAreThoseOfOneCamera) {
  EXPECT_THAT(message_of(with_sensors("sensors.wide = { kind = \"camera\" }\nsensors.narrow = { kind = \"camera\" }\n"
                                      "sensors.gnss = {}")),
              HasSubstr("sensors.narrow.navigation: found a second camera whose bearings navigation uses; accepted: "
                        "\"angles_only\" for one camera of a spacecraft; \"pose\" or \"none\" for the others"));
}

TEST(Sensors, AreRefusedWithOneMessage) {
  EXPECT_THAT(message_of(with_sensors("sensors.navigation = {}\nsensors.navigation = {}")),
              HasSubstr("cannot redefine existing table"));
  EXPECT_THAT(
      message_of(with_sensors("sensors.eye = { kind = \"kamera\" }")),
      HasSubstr("sensors.eye.kind: found the text \"kamera\" (did you mean camera?); accepted: navigation, gnss, "
                "camera or range_finder"));
  EXPECT_THAT(message_of(with_sensors("sensors.eye = {}")),
              HasSubstr("sensors.eye.kind: found nothing, and the sensor has the name \"eye\"; accepted: "));
  EXPECT_THAT(message_of(with_sensors("sensors.navigation = { readout_s = 1 }")),
              HasSubstr("sensors.navigation.readout_s: found an unknown key; accepted: kind, source, log, target or "
                        "period_s"));
  EXPECT_THAT(message_of(with_sensors("sensors.navigation = 3")),
              HasSubstr("sensors.navigation: found the integer 3; accepted: a table"));
  EXPECT_THAT(message_of(with_sensors("sensors.\"a b\" = { kind = \"camera\" }")),
              HasSubstr("found the name \"a b\"; accepted: a name of 1 to 64 letters"));
  EXPECT_THAT(message_of(with_sensors("sensors.one = { kind = \"gnss\" }\nsensors.two = { kind = \"gnss\" }")),
              HasSubstr("found a second sensor of kind gnss"));
}

// A camera file outside the data folder, seen from the mission file.
TEST(Sensors, CameraFileByPath) {
  const auto folder = std::filesystem::path(testing::TempDir()) / ("vbar_sensors_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  std::filesystem::copy_file(vbar::tests::source_path("data/cameras/tron.toml"), folder / "calibrated.toml",
                             std::filesystem::copy_options::overwrite_existing);
  const auto load = [&](const std::string& file) {
    return parse_mission(with_sensors("sensors.gnss = {}\nsensors.camera = { camera = \"" + file + "\" }"),
                         folder / "m.toml");
  };
  EXPECT_EQ(sensor_of<CameraSensor>(load("./calibrated.toml")).settings.optics.focal_length_mm, 17.0);
  EXPECT_EQ(sensor_of<CameraSensor>(load((folder / "calibrated.toml").string())).settings.optics.focal_length_mm, 17.0);
  try {
    static_cast<void>(load("./missing.toml"));
    ADD_FAILURE() << "a missing file was read";
  } catch (const MissionError& error) {
    EXPECT_THAT(error.what(), HasSubstr("missing.toml: found no such file; accepted: a camera file (TOML)"));
  }
  std::filesystem::remove_all(folder);
}

// ------------------------------------------------------------------------------------------------------------ testbeds

struct Bench : TestbedSettings {
  int port = 0;
};

constexpr TestbedReader kBench{"bench", [](const TableReader& section) -> std::shared_ptr<const TestbedSettings> {
                                 auto bench = std::make_shared<Bench>();
                                 bench->port = static_cast<int>(section.integer("port", 1, 65535));
                                 return bench;
                               }};

std::string message_with_bench(const std::string& text) {
  Installation installation = sensors::installation();
  installation.testbeds = {&kBench};
  try {
    static_cast<void>(mission::parse_mission(text, "m.toml", {}, installation));
  } catch (const MissionError& error) {
    return error.what();
  }
  return {};
}

TEST(Testbeds, AreReadByTheirDriver) {
  Installation installation = sensors::installation();
  installation.testbeds = {&kBench};
  const std::string text = changed(with_sensors("sensors.gnss = {}\nsensors.camera = { source = \"bench\" }"),
                                   "[mission]", "[testbed.bench]\nport = 4000\n[mission]");
  const Mission mission = mission::parse_mission(text, "m.toml", {}, installation);
  ASSERT_EQ(mission.testbeds.size(), 1U);
  EXPECT_EQ(dynamic_cast<const Bench&>(*mission.testbeds[0].settings).port, 4000);
  EXPECT_EQ(sensor_of<CameraSensor>(mission).source, "bench");
}

TEST(Testbeds, BadKeysEndWithFileAndLine) {
  const auto with_table = [](const std::string& table) { return changed(kSmall, "[mission]", table + "\n[mission]"); };
  EXPECT_EQ(message_with_bench(with_table("[testbed.bench]\nport = 0")),
            "m.toml:3: testbed.bench.port: found the integer 0; accepted: an integer from 1 to 65535");
  EXPECT_EQ(message_with_bench(with_table("[testbed.bench]\nport = 1\nprot = 2")),
            "m.toml:4: testbed.bench.prot: found an unknown key (did you mean port?); accepted: port");
  EXPECT_EQ(message_with_bench(with_table("[testbed.other]\nport = 1")),
            "m.toml:2: testbed.other: found a testbed without a driver in this program; accepted: bench");
  // The list depends on the libraries that the program was built with.
  EXPECT_THAT(message_of(with_table("[testbed.bench]\nport = 1")),
              ::testing::StartsWith(
                  "m.toml:2: testbed.bench: found a testbed without a driver in this program; accepted: grand"));
}

// -------------------------------------------------------------------------------------------------------- clock source

TEST(ClockSource, IsMadeByName) {
  EXPECT_EQ(small_mission().clock_source, "monotonic");
  Installation installation = sensors::installation();
  static std::string device;
  static constexpr engine::WallClockSource kFollowed{"ptp",
                                                     [](std::string_view given) -> std::unique_ptr<engine::WallClock> {
                                                       device = given;
                                                       return std::make_unique<engine::SteadyWallClock>();
                                                     }};
  installation.clocks.push_back(&kFollowed);
  const Mission mission =
      mission::parse_mission(kSmall, "m.toml", std::vector<std::string>{"clock.source=ptp:/dev/ptp0"}, installation);
  EXPECT_NE(make_wall_clock(mission, installation), nullptr);
  EXPECT_EQ(device, "/dev/ptp0");
}

TEST(ClockSource, UnknownOnesAreRefused) {
  EXPECT_EQ(message_of(kSmall, {"clock.source=ptp:/dev/ptp0"}),
            "--set clock.source=ptp:/dev/ptp0: clock.source: found the text \"ptp:/dev/ptp0\"; accepted: monotonic or "
            "pps, the clock sources that this program has");
}

}  // namespace
}  // namespace vbar::mission::test
