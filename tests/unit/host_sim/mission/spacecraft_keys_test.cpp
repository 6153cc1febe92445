// One section for many spacecraft.

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "host_sim/mission/mission.h"
#include "host_sim/mission/read_sections.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {

namespace {

const std::string kSwarm = R"(
[mission]
duration_h = 1
[[spacecraft]]
name = "swarm"
count = 12
mass_kg = 10.0
spacing = { mean_argument_of_latitude_deg = 70.0, inclination_deg = 0.5, mass_kg = 0.25 }
[spacecraft.elements]
kind = "mean"
semi_major_axis_km = 7000
ex = 0.001
ey = 0
inclination_deg = 60
raan_deg = 20
mean_argument_of_latitude_deg = -10
[[spacecraft]]
name = "observer"
elements = { kind = "mean", semi_major_axis_km = 7000, ex = 0, ey = 0, inclination_deg = 98, raan_deg = 0, mean_argument_of_latitude_deg = 0 }
)";

constexpr double kDegree = 3.14159265358979323846 / 180.0;

TEST(SpacecraftGroup, IsSpacedFromEachToTheNext) {
  const Mission mission = parse_mission(kSwarm, "m.toml");
  ASSERT_EQ(mission.spacecraft.size(), 13U);
  EXPECT_EQ(mission.spacecraft[0].name, "swarm_01");
  EXPECT_EQ(mission.spacecraft[11].name, "swarm_12");
  EXPECT_EQ(mission.spacecraft[12].name, "observer");
  for (int k = 0; k < 12; ++k) {
    const Spacecraft& spacecraft = mission.spacecraft[static_cast<std::size_t>(k)];
    const fsw::orbit::QnsElements& elements = std::get<OrbitByElements>(spacecraft.orbit).elements;
    EXPECT_EQ(spacecraft.number, k + 1);
    EXPECT_DOUBLE_EQ(spacecraft.surface.mass_kg, 10.0 + 0.25 * k);
    EXPECT_DOUBLE_EQ(elements.a, 7e6);
    EXPECT_DOUBLE_EQ(elements.i, (60.0 + 0.5 * k) * kDegree);
    EXPECT_DOUBLE_EQ(elements.raan, 20.0 * kDegree);
    // The same direction; a sum of hundreds of degrees may come back to one within a turn.
    EXPECT_NEAR(std::remainder(elements.u - (-10.0 + 70.0 * k) * kDegree, 360.0 * kDegree), 0.0, 1e-14 * 12);
    EXPECT_LE(std::abs(elements.u), 360.0 * kDegree);
  }
}

TEST(SpacecraftGroup, IsSetByItsName) {
  const std::vector<std::string> overrides{"spacecraft.swarm.count=3", "spacecraft.swarm.spacing.raan_deg=120"};
  const Mission mission = parse_mission(kSwarm, "m.toml", overrides);
  ASSERT_EQ(mission.spacecraft.size(), 4U);
  EXPECT_EQ(mission.spacecraft[2].name, "swarm_3");
  EXPECT_DOUBLE_EQ(std::get<OrbitByElements>(mission.spacecraft[2].orbit).elements.raan, 260.0 * kDegree);
}

TEST(SpacecraftGroup, BadOnesEndWithOneMessage) {
  const auto message = [](std::string_view what, std::string_view by) { return message_of(changed(kSwarm, what, by)); };
  EXPECT_EQ(message("count = 12\n", ""),
            "m.toml:4: spacecraft.0.count: found nothing; accepted: how many spacecraft the spacing is for");
  EXPECT_EQ(message("count = 12", "count = 10001"),
            "m.toml:6: spacecraft.0.count: found the integer 10001; accepted: an integer from 1 to 10000");
  EXPECT_EQ(message("\"observer\"", "\"observer\"\ncount = 9989"),
            "m.toml:19: spacecraft.1.count: found 10001 spacecraft up to here; accepted: up to 10000 in a mission");
  EXPECT_EQ(
      message("inclination_deg = 0.5", "inclination_deg = 12.0"),
      "m.toml:8: spacecraft.swarm.spacing.inclination_deg: found 180 for swarm_11; accepted: a number from 0.01 to "
      "179.99");
  EXPECT_EQ(
      message("mass_kg = 0.25", "mass_kg = -1.0"),
      "m.toml:8: spacecraft.swarm.spacing.mass_kg: found 0 for swarm_11; accepted: a number above 0, up to 1000000");
  EXPECT_EQ(message("mass_kg = 0.25", "mas_kg = 0.25"),
            "m.toml:8: spacecraft.swarm.spacing.mas_kg: found an unknown key (did you mean mass_kg?); accepted: "
            "mass_kg, drag_area_m2, drag_coefficient, radiation_area_m2, radiation_coefficient, semi_major_axis_km, "
            "ex, ey, inclination_deg, raan_deg or mean_argument_of_latitude_deg");
  EXPECT_EQ(message("\"observer\"", "\"swarm_07\""),
            "m.toml:18: spacecraft.1.name: found a second spacecraft \"swarm_07\"; accepted: a name used once");
  EXPECT_EQ(message("mass_kg = 10.0", "mass_kg = 10.0\nnumber = 250"),
            "m.toml:8: spacecraft.swarm.number: found 256 for swarm_07; accepted: numbers up to 255");
}

TEST(SpacecraftGroup, HasAsManyMembersAsThereAreSpacecraftAndNumbersAsFarAsHeadersStateThem) {
  const std::vector<std::string> overrides{"spacecraft.swarm.count=9999",
                                           "spacecraft.swarm.spacing.inclination_deg=0.001"};
  const Mission mission = parse_mission(kSwarm, "m.toml", overrides);
  ASSERT_EQ(mission.spacecraft.size(), 10'000U);
  EXPECT_EQ(mission.spacecraft[254].name, "swarm_0255");
  EXPECT_EQ(mission.spacecraft[254].number, 255);
  EXPECT_EQ(mission.spacecraft[255].number, kNoSpacecraftNumber);
  EXPECT_EQ(mission.spacecraft[9998].name, "swarm_9999");
  EXPECT_EQ(mission.spacecraft[9999].number, kNoSpacecraftNumber);
}

TEST(SpacecraftGroup, BeyondTheRangeOfNumbersCarriesNoSensorsWithoutOne) {
  const std::string many = changed(kSwarm, "count = 12", "count = 300");
  const std::string text =
      changed(many, "inclination_deg = 0.5", "inclination_deg = 0.1") + "sensors.navigation = {}\n";
  EXPECT_THAT(message_of(text),
              testing::HasSubstr("spacecraft.observer.number: found nothing for spacecraft 301 of the file, whose "
                                 "packets need a number; accepted: a number from 1 to 255 that is used once"));
}

TEST(SpacecraftGroup, CannotStandAtOneWaypoint) {
  EXPECT_EQ(message_of(changed(kSmallMission.data(), "name = \"target\"", "name = \"target\"\ncount = 2")),
            "m.toml:21: spacecraft.1.relative: found one place for 2 spacecraft; accepted: elements, with a spacing");
}

}  // namespace

// Named sensors, testbeds and clock sources of a mission: what is accepted, and the one message that refuses the rest.

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

// [truth]: forces, data files and accuracy as a mission file says them.

namespace {

std::string with_truth(const std::string& lines) {
  return kSmall + "[truth]\n" + lines + "\n";
}

truth::TruthSettings truth_of(const std::string& lines) {
  return parse_mission(with_truth(lines), "somewhere/m.toml").truth;
}

TEST(TruthKeys, WithoutThemGravityAlone) {
  const truth::TruthSettings settings = small_mission().truth;
  const truth::ForceModel& forces = settings.forces;
  EXPECT_FALSE(forces.drag || forces.radiation_pressure || forces.sun || forces.moon || forces.solid_tides ||
               forces.relativity);
  EXPECT_EQ(settings.gravity_degree, 60);
  EXPECT_EQ(settings.gravity_order, 60);
  EXPECT_EQ(settings.tolerance, truth::TruthSettings{}.tolerance) << "one default for missions and model";
}

TEST(TruthKeys, EachSwitchesItsForce) {
  using truth::ForceModel;
  const auto forces = [](const std::string& line) { return truth_of(line).forces; };
  EXPECT_TRUE(forces("drag = true").drag);
  EXPECT_TRUE(forces("radiation_pressure = true").radiation_pressure);
  EXPECT_TRUE(forces("sun = true").sun);
  EXPECT_TRUE(forces("moon = true").moon);
  EXPECT_TRUE(forces("solid_tides = true").solid_tides);
  EXPECT_TRUE(forces("relativity = true").relativity);
  EXPECT_EQ(forces("geomagnetic_index = \"three_hourly\"").geomagnetic_index, truth::GeomagneticIndex::kThreeHourly);
  EXPECT_EQ(forces("geomagnetic_index = \"daily\"").geomagnetic_index, truth::GeomagneticIndex::kDaily);
  EXPECT_EQ(forces("shadow = \"none\"").shadow, truth::Shadow::kNone);
  EXPECT_EQ(forces("shadow = \"cylindrical\"").shadow, truth::Shadow::kCylindrical);
  EXPECT_EQ(forces("shadow = \"conical\"").shadow, truth::Shadow::kConical);
}

TEST(TruthKeys, TheTruthKnowsWhenTheRunEnds) {
  const Mission mission = small_mission({"mission.start_h=1.5"});
  EXPECT_EQ(mission.truth.epoch, mission.epoch);
  EXPECT_EQ(mission.truth.end - mission.truth.epoch, fsw::duration_of_seconds(12600));  // 1.5 h and the 2 h of the run
}

TEST(TruthKeys, FilesAreOfTheDataFolderOrSeenFromTheMission) {
  EXPECT_EQ(truth_of("gravity_file = \"gravity/mine.txt\"").gravity_file, "gravity/mine.txt");
  EXPECT_EQ(truth_of("earth_orientation_file = \"/data/eop.csv\"").earth_orientation_file, "/data/eop.csv");
  EXPECT_EQ(truth_of("space_weather_file = \"./sw.csv\"").space_weather_file,
            std::filesystem::current_path() / "somewhere" / "./sw.csv");
  EXPECT_EQ(truth_of("gravity_file = \"../g.txt\"").gravity_file,
            std::filesystem::current_path() / "somewhere" / "../g.txt");
}

TEST(TruthKeys, BadValuesEndWithOneMessage) {
  const auto message = [](const std::string& line) { return message_of(with_truth(line)); };
  const std::string where = "m.toml:" + line_of_text(with_truth("X"), "X") + ": truth.";
  EXPECT_EQ(message("drag = 1"), where + "drag: found the integer 1; accepted: true or false");
  EXPECT_EQ(
      message("shadow = \"conicl\""),
      where + "shadow: found the text \"conicl\" (did you mean conical?); accepted: none, cylindrical or conical");
  EXPECT_EQ(message("geomagnetic_index = \"hourly\""),
            where + "geomagnetic_index: found the text \"hourly\"; accepted: daily or three_hourly");
  EXPECT_EQ(message("solid_tide = true"),
            where +
                "solid_tide: found an unknown key (did you mean solid_tides?); accepted: source, gravity_degree, "
                "gravity_order, drag, geomagnetic_index, radiation_pressure, shadow, sun, moon, solid_tides, "
                "relativity, permanent_tide, relative_tolerance, threads, gravity_file, earth_orientation_file, "
                "space_weather_file, constant_f107, constant_ap or accept_predictions");
  EXPECT_EQ(message("solid_tides = true\npermanent_tide = false"),
            "m.toml:" + line_of_text(with_truth("solid_tides = true\nX"), "X") +
                ": truth.permanent_tide: found false; accepted: true, as truth.solid_tides contains the "
                "permanent tide");
  EXPECT_EQ(message("relative_tolerance = 1e-15"),
            where + "relative_tolerance: found the number 1e-15; accepted: a number from 1e-14 to 1e-06");
  EXPECT_EQ(message("relative_tolerance = 1e-5"),
            where + "relative_tolerance: found the number 1e-05; accepted: a number from 1e-14 to 1e-06");
  EXPECT_EQ(message("gravity_file = \"\""), where +
                                                "gravity_file: found the text \"\"; accepted: a file of the data "
                                                "folder, or one seen from the mission file (./...)");
}

// A file for the truth alone: spacecraft on orbits and nothing else.
TEST(TruthKeys, AMissionNeedsNoFlightComputer) {
  const std::string text = R"(
[mission]
duration_h = 1
[[spacecraft]]
name = "alone"
elements = { kind = "mean", semi_major_axis_km = 7000, ex = 0, ey = 0, inclination_deg = 98, raan_deg = 0, mean_argument_of_latitude_deg = 0 }
)";
  EXPECT_EQ(message_of(text), "");
  EXPECT_FALSE(parse_mission(text, "m.toml").flies());
  EXPECT_TRUE(small_mission().flies());
}

const std::string kThruster = "spacecraft.servicer.actuators.thruster=";

TEST(FiniteThrusterKeys, AreRead) {
  const Mission mission = small_mission(
      {kThruster + "{thrust_n=0.02, specific_impulse_s=65, propellant_kg=0.5, minimum_impulse_mns=2, rise_s=0.1}"});
  const auto& finite = mission.find_spacecraft("servicer")->thruster->finite;
  ASSERT_TRUE(finite);
  EXPECT_EQ(finite->thrust_n, 0.02);
  EXPECT_DOUBLE_EQ(finite->exhaust_velocity_mps(), 65.0 * 9.80665);
  EXPECT_DOUBLE_EQ(finite->minimum_impulse_ns, 2e-3);
  EXPECT_EQ(finite->maximum_on_time_s, 300.0);
  EXPECT_EQ(finite->fall_s, 0.0);
  EXPECT_FALSE(small_mission({}).find_spacecraft("servicer")->thruster->finite);
}

TEST(FiniteThrusterKeys, BadOnesEndWithOneMessage) {
  const auto with = [](const std::string& keys) {
    return message_of(std::string(kSmallMission), {kThruster + "{" + keys + "}"});
  };
  EXPECT_THAT(with("thrust_n=0, specific_impulse_s=65, propellant_kg=1"),
              testing::HasSubstr("thrust_n: found the integer 0"));
  EXPECT_THAT(with("thrust_n=1, specific_impulse_s=-65, propellant_kg=1"),
              testing::HasSubstr("specific_impulse_s: found"));
  EXPECT_THAT(with("thrust_n=1, propellant_kg=1"), testing::HasSubstr("specific_impulse_s: found nothing"));
  EXPECT_THAT(with("thrust_n=1, specific_impulse_s=65"), testing::HasSubstr("propellant_kg: found nothing"));
  EXPECT_THAT(with("thrust_n=1, specific_impulse_s=65, propellant_kg=154"), testing::HasSubstr("less than mass_kg"));
  EXPECT_THAT(with("minimum_impulse_mns=1"), testing::HasSubstr("it with thrust_n"));
  EXPECT_THAT(with("thrust_n=1, specific_impulse_s=65, propellant_kg=1, max_thrust_n=2"),
              testing::HasSubstr("thrust_n alone"));
  EXPECT_THAT(with("thrust_n=0.001, specific_impulse_s=65, propellant_kg=1, minimum_impulse_mns=500"),
              testing::HasSubstr("a time in which thrust_n gives minimum_impulse_mns"));
}

}  // namespace

}  // namespace vbar::mission::test
