// Not one lucky case: the same rendezvous from other starts, in other gravity, with other sensors and a thruster that
// errs. Each flight must meet every waypoint and cost about what the nominal one does.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <erfa.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "fsw/orbit/rtn.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/orbit_files/orbit_file.h"
#include "host_sim/simulation/initial_state.h"
#include "tests/integration/rendezvous/run_mission.h"
#include "tests/support/paths.h"

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

// The spacecraft stand where the mission says before anything flies.

namespace {

struct Pair {
  fsw::orbit::CartesianState servicer;
  fsw::orbit::CartesianState target;
};

Pair placed(const std::vector<std::string>& overrides = {}) {
  const std::string root = vbar::tests::source_path();
  const mission::Mission mission = sensors::load_mission(root + "/missions/ideal_navigation.toml", overrides);
  truth::TruthSettings settings;
  settings.epoch = mission.epoch;
  settings.gravity_degree = mission.truth.gravity_degree;
  settings.gravity_order = mission.truth.gravity_order;
  settings.data_directory = root + "/data";
  truth::TruthModel truth(settings);
  app::place_spacecraft(mission, root + "/data", truth);
  EXPECT_EQ(truth.time(), mission.start_time());
  return {truth.state("servicer"), truth.state("target")};
}

fsw::Vector3 relative_position(const Pair& pair) {
  return fsw::orbit::relative_state_rtn(pair.servicer, pair.target).position_rtn;
}

// The paper's table of servicer elements, read as osculating, by an independent implementation of the element
// conversion.
TEST(InitialOrbits, TheServicerFliesThePapersElements) {
  const Pair pair = placed();
  const fsw::Vector3 position(12161.8456633, -7076153.584868, -84606.5539942);
  const fsw::Vector3 velocity(-1068.5690877908, -90.5830005301, 7433.7358593127);
  // The numbers' last digits; seven million metres in double precision are good to 1e-9 m.
  EXPECT_LT((pair.servicer.position_eci - position).norm(), 1e-6);
  EXPECT_LT((pair.servicer.velocity_eci - velocity).norm(), 1e-9);
}

// Waypoint 0 through mean elements, osculating elements and ECI, by an independent implementation. That one lacks a
// first-order term of the mean longitude, proportional to the eccentricity: 6 m here, turning with the latitude, so up
// to 6.4 cm between spacecraft 75 km apart.
TEST(InitialOrbits, TheTargetStandsAtItsWaypoint) {
  const fsw::Vector3 difference = relative_position(placed()) - fsw::Vector3(-2393.793, -75134.098, -13.938);
  EXPECT_LT(std::abs(difference.x()), 1e-3);  // half the reference's last digit, and the same of its elements'
  EXPECT_LT(std::abs(difference.y()), 0.064);
  EXPECT_LT(std::abs(difference.z()), 1e-3);
}

TEST(InitialOrbits, ElementsAreAsGoodAsTheirWaypoint) {
  const Pair at_waypoint = placed();
  const Pair by_roe = placed({"spacecraft.target.relative={to='servicer', a_roe_m=[-2000, -75000, 0, 0, 0, 0]}"});
  EXPECT_EQ(by_roe.target.position_eci, at_waypoint.target.position_eci);
  EXPECT_EQ(by_roe.target.velocity_eci, at_waypoint.target.velocity_eci);
}

// The error of the mass is that of the truth's forces: with a sigma seven times the mass some seeds draw a mass below
// zero, which is refused by name; the true mass otherwise stretches what sunlight and drag do over 39 h.
TEST(InitialOrbits, TheTrueMassIsDrawn) {
  const std::string root = vbar::tests::source_path();
  const auto servicer_of = [&](int seed, const std::string& sigma_kg) {
    const mission::Mission mission = sensors::load_mission(
        root + "/missions/experiment3.toml", std::vector<std::string>{"mission.seed=" + std::to_string(seed),
                                                                      "spacecraft.servicer.mass_sigma_kg=" + sigma_kg});
    truth::TruthModel truth(app::truth_settings(mission, root + "/data"));
    app::place_spacecraft(mission, root + "/data", truth);
    return truth.state("servicer").position_eci;
  };
  const double moved = (servicer_of(1, "10") - servicer_of(1, "0")).norm();
  // Drag of 1e-7 m/s^2 over 39 h displaces by kilometres; a tenth of the mass is a tenth of that.
  EXPECT_GT(moved, 1.0);
  EXPECT_LT(moved, 1e4);
  int without = 0;
  for (int seed = 1; seed <= 20 && without == 0; ++seed) {
    try {
      servicer_of(seed, "1000");
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "spacecraft \"servicer\": the mass drawn with its mass_sigma_kg is not positive");
      ++without;
    }
  }
  EXPECT_GT(without, 0);
}

// A run that starts 39 h in: the servicer has flown there unburned, the target is placed about it at waypoint 8. The
// reference propagated the servicer by mean elements to an argument of latitude of -122.379 deg; over 39 h the
// first-order theory's mean semi-major axis, good to 15 m, leaves 1 mrad of it, which turns the 2 m ellipse by 2 mm.
TEST(InitialOrbits, ALaterStartIsPlacedAboutTheServicerOfThatTime) {
  const Pair pair = placed({"mission.start_h=39.0", "mission.duration_h=2.25", "spacecraft.target.relative.waypoint=8",
                            "truth.gravity_degree=2", "truth.gravity_order=0"});
  const fsw::Vector3 expected(1.19963, -7.85458, 0.53876);
  EXPECT_LT((relative_position(pair) - expected).norm(), 0.005);
}

// The precise orbit of Swarm A as SP3, and the same Earth-fixed states as an OEM: one state in GCRF. Its position by
// ERFA's own matrix of the IAU 2006/2000A conventions, without polar motion and with UT1 = UTC, as the run assumes for
// 2022; the truth model interpolates the pole to 1e-12 rad.
TEST(InitialOrbits, EarthFixedStatesOfAnOemAreThoseOfAnSp3File) {
  const std::string sp3 = vbar::tests::source_path("tests/data/formats/swarm_a_2022_excerpt.sp3");
  const auto oem = std::filesystem::path(testing::TempDir()) / fmt::format("vbar_itrf_{}.oem", ::getpid());
  const orbit_files::OrbitFile file = orbit_files::load_orbits(sp3);
  std::ofstream text(oem);
  text << "CCSDS_OEM_VERS = 2.0\nMETA_START\nOBJECT_NAME = SWARM\nCENTER_NAME = EARTH\nREF_FRAME = ITRF2014\n"
          "TIME_SYSTEM = GPS\nMETA_STOP\n";
  for (std::size_t k = 0; k < 9; ++k) {
    const auto& [position, velocity] = file.tracks.at(0).states.at(k).state;
    text << fmt::format("2022-01-01T00:{:02}:00 {:.7f} {:.7f} {:.7f} {:.11f} {:.11f} {:.11f}\n", k, 1e-3 * position.x(),
                        1e-3 * position.y(), 1e-3 * position.z(), 1e-3 * velocity.x(), 1e-3 * velocity.y(),
                        1e-3 * velocity.z());
  }
  text.close();
  const auto flown = [&](const std::string& orbit) {
    // 00:04:00 of GPS time.
    return placed({"mission.epoch_utc=2022-01-01T00:03:42Z", "spacecraft.servicer.orbit_file=" + orbit}).servicer;
  };
  const auto by_sp3 = flown(sp3), by_oem = flown(oem);
  std::filesystem::remove(oem);
  EXPECT_LT((by_oem.position_eci - by_sp3.position_eci).norm(), 1e-6);
  EXPECT_LT((by_oem.velocity_eci - by_sp3.velocity_eci).norm(), 1e-9);
  double R[3][3];  // to ITRF from GCRF
  const double day = 2459580.5, utc = 222.0 / 86400.0, tt = utc + (37.0 + 32.184) / 86400.0;
  eraC2t06a(day, tt, day, utc, 0.0, 0.0, R);
  const fsw::Vector3& itrf = file.tracks.at(0).states.at(4).state.position_eci;
  const fsw::Matrix3 R_itrf_gcrf = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&R[0][0]);
  // 7e6 m at 1e-12 rad of the pole and 4e-11 rad of a Julian date in two doubles.
  EXPECT_LT((R_itrf_gcrf.transpose() * itrf - by_oem.position_eci).norm(), 1e-3);
}

}  // namespace

}  // namespace vbar::test
