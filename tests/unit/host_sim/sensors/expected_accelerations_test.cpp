// Differential accelerations that navigation expects, and the process noise that covers them.

#include "host_sim/installation/expected_accelerations.h"

#include <cmath>

#include <gmock/gmock.h>

#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/mission.h"
#include "host_sim/truth/force_list.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::sensors {
namespace {

using mission::test::changed;
using testing::HasSubstr;

constexpr double kMu = 3.986004418e14;

/// A camera mission under drag and radiation pressure.
mission::Mission mission_of(const std::vector<std::string>& settings = {}) {
  std::string text = changed(std::string(mission::test::kSmallMission), "sensors.navigation = {}",
                             "attitude = { profile = \"commanded\" }\nsensors.gnss = {}\n"
                             "sensors.far = { kind = \"camera\", navigation = \"angles_only\" }\n");
  text = changed(text, "relative = {", "model = \"tango\"\nattitude = { profile = \"tumble\" }\nrelative = {");
  std::vector<std::string> overrides = {"truth.drag=true", "truth.radiation_pressure=true",
                                        "truth.space_weather_file=\"constant\""};
  overrides.insert(overrides.end(), settings.begin(), settings.end());
  return parse_mission(text, "m.toml", overrides);
}

const mission::ProcessNoiseKeys& keys_of(const mission::Mission& mission) {
  return mission::shared_settings<mission::ProcessNoiseKeys>(mission);
}

/// A circular orbit in the plane of 51.6 deg.
fsw::orbit::CartesianState circular(double altitude_m) {
  const double r = 6378137.0 + altitude_m, v = std::sqrt(kMu / r), i = 51.6 * M_PI / 180.0;
  return {.position_eci = {r, 0.0, 0.0}, .velocity_eci = {0.0, v * std::cos(i), v * std::sin(i)}};
}

ExpectedAccelerations expected_at(double altitude_m, const mission::Mission& mission) {
  truth::TruthSettings settings = mission.truth;
  settings.epoch = mission.start_time();
  settings.end = mission.end_time();
  settings.data_directory = vbar::tests::source_path("data");
  settings.gravity_degree = settings.gravity_order = 2;
  const truth::ForceData data = truth::load_force_data(settings);
  return expected_accelerations(mission, mission.spacecraft[0], mission.spacecraft[1], data, circular(altitude_m));
}

/// Vallado (Fundamentals of Astrodynamics, table 8-4, mean solar activity): 3.7e-12 kg/m^3 at 400 km, 3.6e-14 at 700
/// km, 3.0e-15 at 1000 km; NRLMSISE-00 with F10.7 of 150 lies within a factor of four of them.
TEST(ExpectedAccelerations, FollowTheDensityOfTheAir) {
  // Own surface of 0.02 m^2/kg, the target's within [0.004, 0.004]: a difference of 0.016.
  const mission::Mission mission =
      mission_of({"spacecraft.servicer.mass_kg=100", "spacecraft.servicer.drag_area_m2=1",
                  "spacecraft.servicer.drag_coefficient=2", "navigation.target_drag_m2_per_kg=[0.004, 0.004]"});
  for (const auto& [altitude_m, density] :
       {std::pair(400e3, 3.7e-12), std::pair(700e3, 3.6e-14), std::pair(1000e3, 3.0e-15)}) {
    const double speed2 = kMu / (6378137.0 + altitude_m);
    const double reference = 0.5 * density * speed2 * 0.016;
    const double drag = expected_at(altitude_m, mission).drag;
    EXPECT_GT(drag, reference / 4.0) << altitude_m;
    EXPECT_LT(drag, reference * 4.0) << altitude_m;
  }
}

/// Solar constant over the speed of light, 1361 / 299792458 N/m^2, times the rms of a difference that is uniform from 0
/// to 0.02 m^2/kg: 0.02 / sqrt(3).
TEST(ExpectedAccelerations, OfRadiationAreThoseOfTheBounds) {
  const mission::Mission mission =
      mission_of({"spacecraft.servicer.mass_kg=100", "spacecraft.servicer.radiation_area_m2=1",
                  "spacecraft.servicer.radiation_coefficient=1", "navigation.target_radiation_m2_per_kg=[0.01, 0.03]"});
  EXPECT_NEAR(expected_at(700e3, mission).radiation, 1361.0 / 299792458.0 * 0.02 / std::sqrt(3.0), 2e-9);
}

TEST(ProcessNoise, OfLikeSpacecraftAt700KilometresIsTheDefault) {
  const mission::Mission mission = mission_of();
  const vbar::navigation_configuration before = mission.navigation.configuration;
  vbar::navigation_configuration after = before;
  const ExpectedAccelerations expected = expected_at(709e3, mission);
  cover(expected, false, after);
  EXPECT_EQ(after.acceleration_psd, before.acceleration_psd);
  EXPECT_EQ(after.acceleration_psd_most, before.acceleration_psd_most);
  EXPECT_TRUE(notes_on(expected, mission, after).empty());
}

/// A servicer of 30 kg and a station of 420 t at 420 km.
const std::vector<std::string> kStation = {
    "spacecraft.servicer.mass_kg=30",           "spacecraft.servicer.drag_area_m2=0.4",
    "spacecraft.servicer.drag_coefficient=2.2", "spacecraft.target.mass_kg=420000",
    "spacecraft.target.drag_area_m2=1500",      "spacecraft.target.drag_coefficient=2.2"};

TEST(ProcessNoise, CoversTheDragOfUnlikeSpacecraft) {
  const mission::Mission mission = mission_of(kStation);
  vbar::navigation_configuration configuration = mission.navigation.configuration;
  const ExpectedAccelerations expected = expected_at(420e3, mission);
  EXPECT_GT(expected.drag, 5e-7);
  cover(expected, keys_of(mission).are_stated, configuration);
  EXPECT_GE(acceleration_of_noise(configuration.acceleration_psd_most, expected.period_s), expected.drag);
  EXPECT_GE(configuration.acceleration_psd_most, configuration.acceleration_psd);
  const auto notes = notes_on(expected, mission, configuration);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_THAT(notes[0], HasSubstr("navigation.acceleration_psd_max is raised to"));
}

TEST(ProcessNoise, ThatTheMissionStatesIsKeptAndNamedIfItIsTooSmall) {
  std::vector<std::string> settings = kStation;
  settings.emplace_back("navigation.acceleration_psd_max=1e-11");
  const mission::Mission mission = mission_of(settings);
  vbar::navigation_configuration configuration = mission.navigation.configuration;
  const ExpectedAccelerations expected = expected_at(420e3, mission);
  cover(expected, keys_of(mission).are_stated, configuration);
  EXPECT_EQ(configuration.acceleration_psd_most, 1e-11);
  const auto notes = notes_on(expected, mission, configuration);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_THAT(notes[0], HasSubstr("the stated navigation.acceleration_psd_max = 1.0e-11"));
}

TEST(KeysOfNavigation, WithoutEffectAreNamed) {
  const mission::Mission mission = mission_of({"navigation.acceleration_sigma_nmps2=1000"});
  ASSERT_EQ(keys_of(mission).without_effect.size(), 1U);
  EXPECT_THAT(keys_of(mission).without_effect[0], HasSubstr("navigation.acceleration_sigma_nmps2 has no effect"));
  EXPECT_TRUE(keys_of(mission_of({"navigation.acceleration_sigma_nmps2=1"})).without_effect.empty()) << "the default";
  EXPECT_TRUE(keys_of(mission_of({"navigation.acceleration_psd_max=1e-9"})).without_effect.empty());
}

TEST(KeysOfNavigation, BoundsAreInOrder) {
  EXPECT_THROW(mission_of({"navigation.target_drag_m2_per_kg=[0.02, 0.01]"}), mission::MissionError);
}

}  // namespace
}  // namespace vbar::sensors
