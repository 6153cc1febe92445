// Placements give back the scene that was asked for, within all limits; what cannot be shown is refused with a reason.

#include "hil_drivers/tron/motion_planning/placement.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/figures.h"
#include "tests/support/paths.h"

namespace vbar::tron {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct Bench {
  TestbedDesign file = read_testbed_design(tests::source_path("data/benches/tron.toml"));
  TestbedBodies bodies{file};
  PathPlanner paths{file, bodies};
  PlacementSearch search(const PlacementSettings& settings = {}) const {
    return {file, bodies, paths, bodies.points_to_see(tests::source_path("data")), settings};
  }
  [[nodiscard]] Posture home() const {
    return {Joints::Map(file.camera_robot.home_rad.data()), Joints::Map(file.target_robot.home_rad.data()),
            file.track.home_m};
  }
};

/// The target seen from its front, 3 m away in the laboratory, the Sun at `phase` from the direction to the camera.
Scene scene(double phase, double spin) {
  Scene scene;
  scene.T_C_T.linear() = (Eigen::AngleAxisd(spin, fsw::Vector3(0.3, 1.0, 0.2).normalized()) *
                          Eigen::AngleAxisd(2.4, fsw::Vector3::UnitX()))
                             .toRotationMatrix();
  scene.T_C_T.translation() << 0.02, -0.03, 3.0;
  const fsw::Vector3 to_camera = -scene.T_C_T.translation().normalized();
  const fsw::Vector3 aside = fsw::Vector3(0.4, 1.0, 0.0).cross(to_camera).normalized();
  scene.sun_C = std::cos(phase) * to_camera + std::sin(phase) * aside;
  return scene;
}

double angle_between(const fsw::Vector3& a, const fsw::Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

TEST(TronPlacement, ShowsTheSceneWithinAllLimits) {
  const Bench bench;
  const PlacementSearch search = bench.search();
  Posture at = bench.home();
  int found_count = 0, shaded_count = 0;
  for (int n = 0; n < 20; ++n) {
    const Scene wanted = scene((60.0 + 3.0 * n) * kDegree, 0.08 * n);
    const auto found = search.find(wanted, at, n);
    if (!std::holds_alternative<Placement>(found)) continue;
    ++found_count;
    const auto& placement = std::get<Placement>(found);
    const ArmPair& arms = bench.bodies.arms();
    EXPECT_LT(accuracy::largest_entry(arms.T_C_T(placement.posture).matrix() - wanted.T_C_T.matrix()), 1e-9);
    const fsw::Vector3 sun_L = arms.camera_pose(placement.posture).linear() * wanted.sun_C;
    EXPECT_LT(angle_between(sun_L, Lamp::direction(placement.lamp_azimuth_rad)), 1e-9);
    EXPECT_GE(placement.lamp_azimuth_rad, bench.file.lamp.azimuth_low_rad);
    EXPECT_LE(placement.lamp_azimuth_rad, bench.file.lamp.azimuth_high_rad);
    EXPECT_TRUE(arms.camera_arm().is_within_limits(placement.posture.camera_rad));
    EXPECT_TRUE(arms.target_arm().is_within_limits(placement.posture.target_rad));
    EXPECT_LE(std::abs(placement.posture.camera_rad[3] + placement.posture.camera_rad[5]),
              bench.file.motion.cable_turn_rad);
    EXPECT_GE(placement.posture.carriage_m, bench.file.track.axis.lower);
    EXPECT_LE(placement.posture.carriage_m, bench.file.track.axis.upper);
    const Bodies bodies = bench.bodies.at(placement.posture);
    EXPECT_EQ(bench.bodies.collision(bodies), "");
    EXPECT_EQ(placement.hidden, bench.bodies.hidden(bodies, bench.bodies.points_to_see(tests::source_path("data"))));
    EXPECT_LE(placement.hidden, 3);
    EXPECT_EQ(placement.shaded, bench.bodies.shaded(bodies, Lamp::direction(placement.lamp_azimuth_rad)));
    shaded_count += placement.shaded;
    const auto path = bench.paths.plan(at, placement.posture);
    ASSERT_TRUE(std::holds_alternative<Path>(path)) << std::get<PathFailure>(path).reason;
    EXPECT_NEAR(std::get<Path>(path).cycles() * bench.file.motion.cycle_s, placement.move_s, 0.0081);
    at = placement.posture;
  }
  EXPECT_GE(found_count, 18);
  EXPECT_LE(shaded_count, found_count) << "of twelve points an image: a shadow costs as much as a second";
}

TEST(TronPlacement, TheNextBestIsTakenWhereTheBestIsRefused) {
  const Bench bench;
  const PlacementSearch search = bench.search();
  const auto best = search.find(scene(1.5, 0.3), bench.home(), 7);
  ASSERT_TRUE(std::holds_alternative<Placement>(best));
  const Joints refused = std::get<Placement>(best).posture.camera_rad;
  const auto next = search.find(scene(1.5, 0.3), bench.home(), 7, std::nullopt,
                                [&](const Posture& posture) { return posture.camera_rad != refused; });
  ASSERT_TRUE(std::holds_alternative<Placement>(next));
  EXPECT_NE(std::get<Placement>(next).posture.camera_rad, refused);
  EXPECT_GE(std::get<Placement>(next).cost_s, std::get<Placement>(best).cost_s);
  const auto none = search.find(scene(1.5, 0.3), bench.home(), 7, std::nullopt, [](const Posture&) { return false; });
  EXPECT_TRUE(std::holds_alternative<NoPlacement>(none));
}

TEST(TronPlacement, IsTheSameForTheSameInput) {
  const Bench bench;
  const PlacementSearch search = bench.search();
  const auto one = search.find(scene(1.5, 0.3), bench.home(), 7), other = search.find(scene(1.5, 0.3), bench.home(), 7);
  const auto third = search.find(scene(1.5, 0.3), bench.home(), 8);
  ASSERT_TRUE(std::holds_alternative<Placement>(one) && std::holds_alternative<Placement>(third));
  EXPECT_EQ(std::get<Placement>(one).posture.camera_rad, std::get<Placement>(other).posture.camera_rad);
  EXPECT_EQ(std::get<Placement>(one).posture.target_rad, std::get<Placement>(other).posture.target_rad);
  EXPECT_EQ(std::get<Placement>(one).lamp_azimuth_rad, std::get<Placement>(other).lamp_azimuth_rad);
  EXPECT_NE(std::get<Placement>(one).posture.camera_rad, std::get<Placement>(third).posture.camera_rad);
}

TEST(TronPlacement, TheTurnIsFreeWithTheSunBehindTheCamera) {
  Bench bench;
  bench.file.lamp.azimuth_low_rad = -20.0 * kDegree;  // this laboratory's lamp does not reach there
  const PlacementSearch search = bench.search();
  const Scene wanted = scene(2.0 * kDegree, 0.2);
  const auto found = search.find(wanted, bench.home(), 1);
  ASSERT_TRUE(std::holds_alternative<Placement>(found)) << std::get<NoPlacement>(found).reason;
  const auto& placement = std::get<Placement>(found);
  EXPECT_LT(accuracy::largest_entry(bench.bodies.arms().T_C_T(placement.posture).matrix() - wanted.T_C_T.matrix()),
            1e-9);
  const fsw::Vector3 sun_L = bench.bodies.arms().camera_pose(placement.posture).linear() * wanted.sun_C;
  EXPECT_NEAR(angle_between(sun_L, Lamp::direction(placement.lamp_azimuth_rad)), placement.sun_error_rad, 1e-9);
}

TEST(TronPlacement, AFixedLampIsAnArcOfOneAngle) {
  Bench bench;
  bench.file.lamp.azimuth_low_rad = bench.file.lamp.azimuth_high_rad = 90.0 * kDegree;
  const Scene wanted = scene(90.0 * kDegree, 0.2);
  const auto found = bench.search().find(wanted, bench.home(), 1);
  ASSERT_TRUE(std::holds_alternative<Placement>(found)) << std::get<NoPlacement>(found).reason;
  const auto& placement = std::get<Placement>(found);
  const fsw::Vector3 sun_L = bench.bodies.arms().camera_pose(placement.posture).linear() * wanted.sun_C;
  EXPECT_LT(angle_between(sun_L, Lamp::direction(90.0 * kDegree)), 1e-9);
}

TEST(TronPlacement, SaysWhyThereIsNone) {
  const Bench bench;
  const PlacementSearch search = bench.search({.trials = 40});
  const auto reason = [&](const Scene& wanted) {
    const auto found = search.find(wanted, bench.home(), 1);
    return std::holds_alternative<NoPlacement>(found) ? std::get<NoPlacement>(found).reason : "";
  };
  Scene far = scene(1.5, 0.2);
  far.T_C_T.translation() *= 4.0;
  EXPECT_NE(reason(far).find("reach"), std::string::npos);
  EXPECT_NE(reason(scene(170.0 * kDegree, 0.2)), "");  // the lamp cannot stand behind the target
  Scene bad = scene(1.5, 0.2);
  bad.sun_C.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(reason(bad).find("not valid"), std::string::npos);
  bad = scene(1.5, 0.2);
  bad.T_C_T.translation().setZero();
  EXPECT_NE(reason(bad).find("not valid"), std::string::npos);
  Posture nowhere = bench.home();
  nowhere.carriage_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::holds_alternative<NoPlacement>(search.find(scene(1.5, 0.2), nowhere, 1)));
}

TEST(TronPlacement, TheEarthsLightCosts) {
  const Bench bench;
  int calls = 0;
  const auto cost = [&](const Scene&, const Eigen::Isometry3d&, const Eigen::Isometry3d&) {
    ++calls;
    return 5.0;
  };
  const PlacementSearch search(bench.file, bench.bodies, bench.paths,
                               bench.bodies.points_to_see(tests::source_path("data")), {.trials = 100}, cost);
  const auto found = search.find(scene(1.5, 0.2), bench.home(), 1);
  ASSERT_TRUE(std::holds_alternative<Placement>(found));
  EXPECT_GT(calls, 0);
  EXPECT_GE(std::get<Placement>(found).cost_s, 5.0);
}

}  // namespace
}  // namespace vbar::tron
