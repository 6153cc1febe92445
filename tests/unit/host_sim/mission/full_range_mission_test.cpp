// missions/full_range.toml flies all waypoints of the paper in one run, with two cameras.

#include <cmath>

#include <gtest/gtest.h>

#include "host_sim/installation/navigation_telecommands.h"
#include "host_sim/sensors/camera/camera_kind.h"
#include "host_sim/sensors/gnss/gnss_kind.h"
#include "tests/support/paths.h"
#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {

namespace {

const Mission& full_range() {
  static const Mission loaded = load_mission(vbar::tests::source_path("missions/full_range.toml"));
  return loaded;
}

// Its waypoints are those of the three experiments.
TEST(FullRangeMission, WaypointsAreThoseOfIdealNavigation) {
  const Mission paper = load_mission(vbar::tests::source_path("missions/ideal_navigation.toml"));
  ASSERT_EQ(full_range().waypoints.size(), 11U);
  ASSERT_EQ(paper.waypoints.size(), 11U);
  for (std::size_t k = 0; k < 11; ++k) {
    EXPECT_EQ(full_range().waypoints[k].index, paper.waypoints[k].index);
    EXPECT_EQ(full_range().waypoints[k].time - full_range().epoch, paper.waypoints[k].time - paper.epoch) << k;
    EXPECT_EQ(full_range().waypoints[k].a_roe_m, paper.waypoints[k].a_roe_m) << k;
    EXPECT_EQ(full_range().waypoints[k].solver, paper.waypoints[k].solver) << k;
  }
  EXPECT_EQ(full_range().end_time(), full_range().waypoints.back().time);
}

TEST(FullRangeMission, OneCameraChangesItsUse) {
  const Spacecraft& servicer = *full_range().find_spacecraft("servicer");
  const auto* const far = sensors::navigation_camera(servicer, 0);
  const auto* const close = sensors::navigation_camera(servicer, 1);
  ASSERT_NE(far, nullptr);
  ASSERT_NE(close, nullptr);
  EXPECT_TRUE(far->changes_use());
  EXPECT_EQ(close->navigation, sensors::CameraSensor::kKeypoints);
  EXPECT_EQ(far->settings.optics.focal_length_mm, 35.0);
  EXPECT_EQ(close->settings.optics.focal_length_mm, 17.0);
  EXPECT_LT(far->keypoint_exposure_s, 50e-6);
}

TEST(FullRangeMission, StepsBecomeShorterOnTheWay) {
  const auto& parts = full_range().step.parts();
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(parts[0].period, fsw::duration_of_seconds(60));
  EXPECT_EQ(parts[2].period, fsw::duration_of_seconds(5));
}

}  // namespace

// missions/full_range_cooperative.toml: the whole mission to a target that cooperates from waypoint 4 on.

namespace {

const Mission& full_range_cooperative() {
  static const Mission loaded = load_mission(vbar::tests::source_path("missions/full_range_cooperative.toml"));
  return loaded;
}

TEST(FullRangeCooperativeMission, UsesAllSourcesFromTheFirstStepOn) {
  using Use = navigation_configuration;
  EXPECT_EQ(sensors::sources_of(*full_range_cooperative().find_spacecraft("servicer")),
            std::int32_t{Use::kUseOwnGnss} + std::int32_t{Use::kUseCarrierPair} + std::int32_t{Use::kUseBearings} +
                std::int32_t{Use::kUseKeypoints});
}

TEST(FullRangeCooperativeMission, TheTargetCooperatesFromWaypoint4On) {
  const fsw::Duration waypoint_4 = full_range_cooperative().waypoints[4].time - full_range_cooperative().epoch;
  const std::vector<LaterAttitude>& later = full_range_cooperative().find_spacecraft("target")->later_attitudes;
  ASSERT_EQ(later.size(), 1U);
  EXPECT_EQ(fsw::nearest_duration(later[0].from_s), waypoint_4);
  EXPECT_EQ(std::get<truth::PointedSettings>(later[0].profile).pointing.boresight_to, truth::Direction::kZenith);
  EXPECT_EQ(shared_settings<sensors::GnssShared>(full_range_cooperative()).crosslink_from, waypoint_4);
}

// What is not of the target is that of full_range.toml.
TEST(FullRangeCooperativeMission, IsOtherwiseTheWholeMission) {
  const Mission whole = load_mission(vbar::tests::source_path("missions/full_range.toml"));
  ASSERT_EQ(full_range_cooperative().waypoints.size(), whole.waypoints.size());
  for (std::size_t k = 0; k < whole.waypoints.size(); ++k) {
    EXPECT_EQ(full_range_cooperative().waypoints[k].a_roe_m, whole.waypoints[k].a_roe_m) << k;
    EXPECT_EQ(full_range_cooperative().waypoints[k].time, whole.waypoints[k].time) << k;
  }
  EXPECT_EQ(full_range_cooperative().end_time(), whole.end_time());
  EXPECT_EQ(full_range_cooperative().spacecraft.size(), whole.spacecraft.size());
}

// Retreat and guard are those of full_range_retreat.toml.
TEST(FullRangeCooperativeMission, HasAVariantWithARetreat) {
  const Mission retreat = load_mission(vbar::tests::source_path("missions/full_range_cooperative_retreat.toml"));
  const Mission alone = load_mission(vbar::tests::source_path("missions/full_range_retreat.toml"));
  EXPECT_FALSE(full_range_cooperative().safety.has_value());
  ASSERT_TRUE(retreat.safety.has_value());
  EXPECT_EQ(packet_of(*retreat.safety), packet_of(*alone.safety));
  EXPECT_EQ(packet_of(retreat.guidance.configuration), packet_of(alone.guidance.configuration));
  EXPECT_EQ(sensors::sources_of(*retreat.find_spacecraft("servicer")),
            sensors::sources_of(*full_range_cooperative().find_spacecraft("servicer")));
  for (std::size_t k = 0; k < retreat.waypoints.size(); ++k)
    EXPECT_EQ(retreat.waypoints[k].keep_out_radius_m, alone.waypoints[k].keep_out_radius_m) << k;
  EXPECT_EQ(retreat.waypoints[8].keep_out_radius_m, 0.8);
}

}  // namespace

// missions/ideal_navigation.toml says what the paper says, and its comments say which defaults the loader has.

namespace {

Mission ideal_navigation() {
  return load_mission(vbar::tests::source_path("missions/ideal_navigation.toml"));
}

// The paper's table "End-to-end Mission ROE Waypoints": time in hours, then a*ROE in metres.
constexpr double kPaperWaypoints[11][7] = {
    {0.0, -2000.0, -75000.0, 0.0, 0.0, 0.0, 0.0},    {6.0, -87.0, -50000.0, 0.0, 1000.0, 0.0, 1000.0},
    {12.0, -70.0, -25000.0, 0.0, 500.0, 0.0, 500.0}, {18.0, -17.0, -5000.0, 0.0, 500.0, 0.0, 500.0},
    {24.0, 0.0, -1000.0, 0.0, 30.0, 0.0, 30.0},      {28.0, 0.0, -600.0, 0.0, 18.0, 0.0, 18.0},
    {32.0, 0.0, -200.0, 0.0, 6.0, 0.0, 6.0},         {36.0, 0.0, -100.0, 0.0, 3.0, 0.0, 3.0},
    {39.0, -0.5, -10.0, 0.0, 2.0, 0.0, 1.0},         {40.0, 0.0, -7.0, 1.0, 0.0, 2.0, 0.0},
    {41.25, 0.0, -8.5, 1.0, 0.0, 1.0, 0.0}};

TEST(IdealNavigationMission, WaypointsAreThePapers) {
  const Mission mission = ideal_navigation();
  ASSERT_EQ(mission.waypoints.size(), 11U);
  for (std::size_t k = 0; k < 11; ++k) {
    const Waypoint& waypoint = mission.waypoints[k];
    EXPECT_EQ(waypoint.index, static_cast<int>(k));
    EXPECT_EQ((waypoint.time - mission.epoch).ns, static_cast<std::int64_t>(kPaperWaypoints[k][0] * 3600e9));
    for (int i = 0; i < 6; ++i) EXPECT_EQ(waypoint.a_roe_m(i), kPaperWaypoints[k][i + 1]) << k << ' ' << i;
    EXPECT_EQ(waypoint.solver, k <= 7 ? Solver{waypoint::kSolverClosedForm} : Solver{waypoint::kSolverKoenigDamico})
        << k;
  }
}

// 2011-07-18 01:00:00 UTC: 11516 days and 1 h after 1980-01-06 (Julian days 2455760.5 and 2444244.5), and 15 leap
// seconds between GPS time and UTC since 2009 (IERS Bulletin C 36).
TEST(IdealNavigationMission, EpochIsThePapers) {
  const Mission mission = ideal_navigation();
  EXPECT_EQ(mission.epoch.ns, (std::int64_t{11516} * 86400 + 3600 + 15) * 1000000000);
  EXPECT_EQ(mission.end_time() - mission.epoch, fsw::duration_of_seconds(148500)) << "41.25 h";
}

TEST(IdealNavigationMission, ServicerElementsAreThePapers) {
  const Mission mission = ideal_navigation();
  const auto& orbit = std::get<OrbitByElements>(mission.find_spacecraft("servicer")->orbit);
  constexpr double kDegree = 3.14159265358979323846 / 180.0;
  EXPECT_EQ(orbit.kind, ElementsKind::kOsculating);
  EXPECT_DOUBLE_EQ(orbit.elements.a, 7087300.0);
  EXPECT_EQ(orbit.elements.ex, 0.0015);
  EXPECT_EQ(orbit.elements.ey, -4.17e-8);
  EXPECT_DOUBLE_EQ(orbit.elements.i, 98.18 * kDegree);
  EXPECT_DOUBLE_EQ(orbit.elements.raan, -90.0 * kDegree);
  EXPECT_DOUBLE_EQ(orbit.elements.u, -0.69 * kDegree);
}

// The file claims to show the defaults, but for the keys it names: a mission without the sections has the same values.
TEST(IdealNavigationMission, CommentsTellTheDefaults) {
  const Mission shown = ideal_navigation();
  const Mission defaults = small_mission({"mission.duration_h=41.25"});
  EXPECT_EQ(shown.epoch, defaults.epoch);
  EXPECT_EQ(shown.start, defaults.start);
  EXPECT_EQ(shown.step, defaults.step);
  EXPECT_EQ(shown.seed, defaults.seed);
  EXPECT_EQ(shown.truth.gravity_degree, defaults.truth.gravity_degree);
  EXPECT_EQ(shown.truth.gravity_order, defaults.truth.gravity_order);
  EXPECT_EQ(shown.truth.tolerance, defaults.truth.tolerance);
  EXPECT_EQ(shown.truth.threads, defaults.truth.threads);
  for (const char* name : {"servicer", "target"}) {
    const SurfaceProperties& a = shown.find_spacecraft(name)->surface;
    const SurfaceProperties& b = defaults.find_spacecraft(name)->surface;
    EXPECT_EQ(a.mass_kg, b.mass_kg);
    EXPECT_EQ(a.drag_area_m2, b.drag_area_m2);
    EXPECT_EQ(a.drag_coefficient, b.drag_coefficient);
    EXPECT_EQ(a.radiation_area_m2, b.radiation_area_m2);
    EXPECT_EQ(a.radiation_coefficient, b.radiation_coefficient);
    EXPECT_EQ(shown.find_spacecraft(name)->number, defaults.find_spacecraft(name)->number);
  }
  const FlightComputer& computer = *shown.find_spacecraft("servicer")->flight_computer;
  const FlightComputer& default_computer = *defaults.find_spacecraft("servicer")->flight_computer;
  EXPECT_EQ(computer.target, default_computer.target);
  EXPECT_EQ(computer.link, default_computer.link);
  EXPECT_EQ(computer.compute_latency, default_computer.compute_latency);
  const auto &sensor = sensor_of<NavigationSensor>(shown), &default_sensor = sensor_of<NavigationSensor>(defaults);
  EXPECT_EQ(sensor.period, default_sensor.period);
  EXPECT_EQ(sensor.observed, default_sensor.observed);
  EXPECT_EQ(sensor.source, default_sensor.source);
  const Guidance& a = shown.guidance;
  const Guidance& b = defaults.guidance;
  EXPECT_EQ(a.mode, b.mode);
  EXPECT_EQ(a.reference_semi_major_axis_m, b.reference_semi_major_axis_m);
  const vbar::gnc_configuration &c = a.configuration, &d = b.configuration;
  EXPECT_EQ(c.compute_latency_ns, d.compute_latency_ns);
  EXPECT_EQ(c.closed_form_period_ns, d.closed_form_period_ns);
  EXPECT_EQ(c.koenig_damico_period_ns, d.koenig_damico_period_ns);
  EXPECT_EQ(c.koenig_damico_grid_ns, d.koenig_damico_grid_ns);
  EXPECT_EQ(c.planner_start_ns, d.planner_start_ns);
  EXPECT_EQ(c.minimum_dv, d.minimum_dv);
  EXPECT_EQ(c.maximum_dv, d.maximum_dv);
  EXPECT_EQ(c.roe_error_threshold_m, d.roe_error_threshold_m);
  EXPECT_EQ(c.station_keeping_deadband_m, d.station_keeping_deadband_m);
  EXPECT_EQ(c.closed_form_tolerance_m, d.closed_form_tolerance_m);
  EXPECT_EQ(c.koenig_damico_tolerance_m, d.koenig_damico_tolerance_m);
  EXPECT_EQ(c.station_keeping_horizon_s, d.station_keeping_horizon_s);
  EXPECT_EQ(c.navigation_timeout_s, d.navigation_timeout_s);
  EXPECT_EQ(shown.clock_source, defaults.clock_source);
  EXPECT_EQ(shown.clock.mode, defaults.clock.mode);
  EXPECT_EQ(shown.clock.speed_factor, defaults.clock.speed_factor);
  EXPECT_EQ(shown.clock.compute_budget, defaults.clock.compute_budget);
  EXPECT_EQ(shown.clock.link_budget, defaults.clock.link_budget);
  EXPECT_EQ(shown.clock.wake_tolerance, defaults.clock.wake_tolerance);
  EXPECT_EQ(shown.board_link.loss_probability, defaults.board_link.loss_probability);
  EXPECT_EQ(shown.lcm.mirror, defaults.lcm.mirror);
  EXPECT_EQ(shown.lcm.url, defaults.lcm.url);
  EXPECT_EQ(shown.record.images, defaults.record.images);
}

}  // namespace

}  // namespace vbar::mission::test
