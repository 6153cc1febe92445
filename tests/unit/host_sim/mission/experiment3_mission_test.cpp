// missions/experiment3.toml flies the paper's waypoints 8 to 10, explains every key of GNSS, and the values it shows
// are the defaults that it says they are.

#include <string>

#include <gtest/gtest.h>

#include "tests/support/paths.h"
#include "tests/unit/host_sim/mission/mission_text.h"
#include "tests/unit/host_sim/mission/shown_keys.h"

namespace vbar::mission::test {
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
}  // namespace vbar::mission::test
