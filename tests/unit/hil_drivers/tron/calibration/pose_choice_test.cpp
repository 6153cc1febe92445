// Postures of a calibration, by the bench as designed.

#include "hil_drivers/tron/calibration/pose_choice.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "hil_drivers/tron/geometry/collision.h"
#include "tests/support/figures.h"
#include "tests/support/paths.h"

namespace vbar::tron::calibrate {
namespace {

TestbedDesign bench() {
  return read_testbed_design(tests::source_path("data/benches/tron.toml"));
}

LensCalibration lens() {
  return {1600, 1000, 2901.0, 2901.0, 799.5, 499.5, {-0.22, 0.51, -6e-4, -2e-4, -0.13}};
}

// The brief (section 5): range 1.2 to 5.6 m, board tilted to 45 deg, any roll, whole track.
TEST(CalibrationPoses, AreDiverseAndSeeTheBoard) {
  const TestbedDesign file = bench();
  const auto postures = choose_postures(file, lens(), BoardDesign{}, 60, 7, {}, free_postures(file));
  ASSERT_EQ(postures.size(), 60U);
  const Eigen::Isometry3d T_T_B = T_target_board(file);
  const Calibration design = calibration_as_designed(file);
  const TestbedBodies bodies(file);
  accuracy::Smallest nearest, low;
  accuracy::Largest farthest, tilt_high, high;
  std::set<int> rolls;
  for (const Posture& posture : postures) {
    EXPECT_EQ(bodies.collision(bodies.at(posture)), "");
    const Eigen::Isometry3d T_C_B = T_C_T_of_arms(design, posture) * T_T_B;
    int seen = 0;
    for (int id = 0; id < BoardDesign{}.corner_count(); ++id) {
      const fsw::Vector2 px = lens().project(T_C_B * BoardDesign{}.corner(id));
      seen += px.x() > 0.0 && px.y() > 0.0 && px.x() < 1599.0 && px.y() < 999.0 ? 1 : 0;
    }
    EXPECT_GE(seen, 37);  // 70 % of 54
    const fsw::Vector3 sight = T_C_B.translation().normalized();
    const double tilt = std::acos(sight.dot(T_C_B.linear().col(2)));
    EXPECT_LE(tilt, M_PI / 4.0 + 1e-6);
    tilt_high.add(tilt);
    nearest.add(T_C_B.translation().norm());
    farthest.add(T_C_B.translation().norm());
    low.add(posture.carriage_m);
    high.add(posture.carriage_m);
    rolls.insert(static_cast<int>(std::floor(std::atan2(T_C_B.linear()(1, 0), T_C_B.linear()(0, 0)) / (M_PI / 4.0))));
    for (Eigen::Index k = 0; k < 6; ++k) {
      const AxisLimits& axis = file.camera_robot.design.axes[static_cast<std::size_t>(k)];
      EXPECT_GT(posture.camera_rad[k], axis.lower);
      EXPECT_LT(posture.target_rad[k], axis.upper);
    }
  }
  EXPECT_LT(nearest, 1.4);
  EXPECT_GT(farthest, 5.3);
  EXPECT_GT(tilt_high, 0.6);
  EXPECT_LT(low, 1.2);
  EXPECT_GT(high, 5.0);
  EXPECT_GE(rolls.size(), 6U);  // of eight octants
}

TEST(CalibrationPoses, AreThoseOfTheSeed) {
  const auto a = choose_postures(bench(), lens(), BoardDesign{}, 5, 7),
             b = choose_postures(bench(), lens(), BoardDesign{}, 5, 7),
             c = choose_postures(bench(), lens(), BoardDesign{}, 5, 8);
  EXPECT_EQ(a.front().camera_rad, b.front().camera_rad);
  EXPECT_NE(a.front().camera_rad, c.front().camera_rad);
}

TEST(CalibrationPoses, OfABenchTooSmallAreRefused) {
  PoseGoals goals;
  goals.range_low_m = 20.0;
  goals.range_high_m = 21.0;
  EXPECT_THROW(static_cast<void>(choose_postures(bench(), lens(), BoardDesign{}, 5, 7, goals)), std::runtime_error);
}

TEST(PatchPoses, ShowThePatchInTheLightOfEverySource) {
  const TestbedDesign file = bench();
  const double azimuth = M_PI / 2.0;
  const auto postures = choose_patch_postures(file, lens(), BoardDesign{}, azimuth, 7, free_postures(file));
  std::set<std::size_t> sources;
  const Calibration design = calibration_as_designed(file);
  for (const PatchPosture& posture : postures) {
    const Eigen::Isometry3d T_L_B = T_L_T_of_arm(design, posture.posture) * T_target_board(file);
    const fsw::Vector3 normal = -T_L_B.linear().col(2);
    const fsw::Vector3 to_camera = T_L_C_of_arm(design, posture.posture).translation() - T_L_B.translation();
    EXPECT_GT(normal.dot(to_camera), 0.0);
    for (const PatchPosture::Light& light : posture.lights) {
      EXPECT_TRUE(sources.insert(light.source).second);
      EXPECT_GT(light.irradiance, 0.0);
      if (light.source == 0) {
        EXPECT_NEAR(light.irradiance, normal.dot(Lamp::direction(azimuth)), 1e-9);
      }
    }
  }
  EXPECT_EQ(sources.size(), kLightSources);
}

}  // namespace
}  // namespace vbar::tron::calibrate
