// One section for many spacecraft.

#include "host_sim/mission/spacecraft_group.h"

#include <cmath>

#include <gtest/gtest.h>

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
  EXPECT_EQ(message("count = 12", "count = 256"),
            "m.toml:6: spacecraft.0.count: found the integer 256; accepted: an integer from 1 to 255");
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

TEST(SpacecraftGroup, CannotStandAtOneWaypoint) {
  EXPECT_EQ(message_of(changed(kSmallMission.data(), "name = \"target\"", "name = \"target\"\ncount = 2")),
            "m.toml:21: spacecraft.1.relative: found one place for 2 spacecraft; accepted: elements, with a spacing");
}

}  // namespace
}  // namespace vbar::mission::test
