// [truth]: forces, data files and accuracy as a mission file says them.

#include <gtest/gtest.h>

#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {
namespace {

const std::string kSmall(kSmallMission);

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

}  // namespace
}  // namespace vbar::mission::test
