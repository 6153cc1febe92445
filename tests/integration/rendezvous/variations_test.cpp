// Not one lucky case: the same rendezvous from other starts, in other gravity, with other sensors and a thruster that
// errs. Each flight must meet every waypoint and cost about what the nominal one does.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/integration/rendezvous/flown_mission.h"

namespace vbar::test {
namespace {

struct Variation {
  const char* name;
  std::vector<std::string> overrides;
};

[[maybe_unused]] void PrintTo(const Variation& variation, std::ostream* out) {
  *out << variation.name;
}

constexpr const char* kThrusterMagnitude = "spacecraft.servicer.actuators.thruster.magnitude_error_percent=1.0";
constexpr const char* kThrusterPointing = "spacecraft.servicer.actuators.thruster.pointing_error_deg=0.5";
constexpr const char* kLatitude = "spacecraft.servicer.elements.mean_argument_of_latitude_deg=";

std::vector<Variation> variations() {
  return {
      // Tens of metres in every element are tens of metres of position and tens of millimetres a second of velocity.
      {"start_nearer", {"waypoint.0.a_roe_m=[-1960.0, -74930.0, 25.0, -40.0, 30.0, -20.0]"}},
      {"start_farther", {"waypoint.0.a_roe_m=[-2050.0, -75080.0, -35.0, 15.0, -25.0, 45.0]"}},
      {"latitude_60", {std::string(kLatitude) + "60.0"}},
      {"latitude_90", {std::string(kLatitude) + "90.0"}},
      {"latitude_150", {std::string(kLatitude) + "150.0"}},
      {"latitude_240", {std::string(kLatitude) + "240.0"}},
      {"latitude_300", {std::string(kLatitude) + "300.0"}},
      {"epoch_later", {"mission.epoch_utc=2011-10-26T13:40:00Z"}},  // other longitudes under the orbit: other tesserals
      {"node_207", {"spacecraft.servicer.elements.raan_deg=207.0"}},
      {"gravity_20", {"truth.gravity_degree=20", "truth.gravity_order=20"}},
      {"gravity_j2", {"truth.gravity_degree=2", "truth.gravity_order=0"}},
      {"thruster_seed_1", {kThrusterMagnitude, kThrusterPointing}},
      {"thruster_seed_2", {kThrusterMagnitude, kThrusterPointing, "mission.seed=2"}},
      {"navigation_120_s", {"spacecraft.servicer.sensors.navigation.period_s=120.0"}},
      {"navigation_300_s", {"spacecraft.servicer.sensors.navigation.period_s=300.0"}},
      {"step_30_s", {"mission.step_s=30.0"}},
      {"late_link", {"links.board.latency={distribution=\"constant\", latency_s=0.5}"}},
      {"lossy_link", {"links.board.loss_probability=0.05"}},
  };
}

const FlownMission& nominal() {
  static const FlownMission flown = fly("ideal_navigation.toml");
  return flown;
}

class Variations : public ::testing::TestWithParam<Variation> {};

TEST_P(Variations, MeetsEveryWaypointAtTheUsualCost) {
  const FlownMission flown = fly("ideal_navigation.toml", GetParam().overrides);
  const report::RunRecord& record = flown.record;
  fmt::print("{:17s}", GetParam().name);
  for (int index = 1; index <= 10; ++index) fmt::print(" {:6.4f}", waypoint(record, index).control_error_m);
  fmt::print(" m; {:5.3f} m/s, {:5.3f} and {:5.3f} mm/s, {} maneuvers\n", dv_commanded_for(record, 0, 7),
             1e3 * dv_commanded_for(record, 8, 8), 1e3 * dv_commanded_for(record, 9, 10), record.summary.maneuvers);

  ASSERT_TRUE(flown.complete);
  // Twice what the nominal mission must do. Far out a plan is flown on while it arrives within a metre; in the middle
  // range and near it is the last burns that decide: a few millimetres a second an hour before, with 1 % of error, are
  // centimetres.
  for (int index = 1; index <= 3; ++index) EXPECT_LT(waypoint(record, index).control_error_m, 4.0) << index;
  for (int index = 4; index <= 7; ++index) EXPECT_LT(waypoint(record, index).control_error_m, 1.0) << index;
  for (int index = 8; index <= 10; ++index) EXPECT_LT(waypoint(record, index).control_error_m, 0.02) << index;

  // The optimum of legs 0 to 7 varies by 3 % over these starts, that of the short legs falls with most of them.
  EXPECT_LT(dv_commanded_for(record, 0, 7), 1.1 * dv_commanded_for(nominal().record, 0, 7));
  EXPECT_LT(dv_commanded_for(record, 8, 8), 1.1 * dv_commanded_for(nominal().record, 8, 8));
  EXPECT_LT(dv_commanded_for(record, 9, 10), 1.1 * dv_commanded_for(nominal().record, 9, 10));
}

INSTANTIATE_TEST_SUITE_P(Mission, Variations, ::testing::ValuesIn(variations()),
                         [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace vbar::test
