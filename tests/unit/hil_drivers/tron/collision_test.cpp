// Distances against sampled ones, and cases that can be worked out.

#include "hil_drivers/tron/geometry/collision.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/figures.h"
#include "tests/support/paths.h"

namespace vbar::tron {

namespace {

using fsw::Vector3;

Vector3 drawn(std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  return {uniform(random), uniform(random), uniform(random)};
}

TEST(TronDistance, OfSegmentsIsTheLeastOfSamples) {
  std::mt19937_64 random(1);
  constexpr int kSamples = 100;
  for (int n = 0; n < 200; ++n) {
    const Vector3 a = drawn(random), b = drawn(random), c = drawn(random), d = drawn(random);
    accuracy::Smallest least;
    for (int i = 0; i <= kSamples; ++i)
      for (int k = 0; k <= kSamples; ++k) least.add((a + (b - a) * i / kSamples - c - (d - c) * k / kSamples).norm());
    const double found = segment_distance(a, b, c, d);
    // The nearest sample is at most half a step, 0.017 m, away on each.
    EXPECT_LE(found, least + 1e-12);
    EXPECT_GE(found, least - 0.035);
  }
}

TEST(TronDistance, OfPointsAndParallels) {
  const Vector3 o = Vector3::Zero(), x = Vector3::UnitX(), y = Vector3::UnitY();
  EXPECT_DOUBLE_EQ(segment_distance(o, o, y, y), 1.0);
  EXPECT_DOUBLE_EQ(segment_distance(o, x, y, y), 1.0);
  EXPECT_DOUBLE_EQ(segment_distance(y, y, o, x), 1.0);
  EXPECT_DOUBLE_EQ(segment_distance(o, x, y, x + y), 1.0);
  EXPECT_DOUBLE_EQ(segment_distance(o, x, 3.0 * x, 5.0 * x), 2.0);
  EXPECT_DOUBLE_EQ(segment_distance(o, x, 0.5 * x - y, 0.5 * x + y), 0.0);
}

TEST(TronDistance, OfABoxIsTheLeastOfSamples) {
  std::mt19937_64 random(2);
  for (int n = 0; n < 200; ++n) {
    OrientedBox box;
    box.T_L_box = Eigen::Translation3d(drawn(random)) * Eigen::Quaterniond::UnitRandom();
    box.half_m = 0.1 * Vector3::Ones() + 0.3 * drawn(random).cwiseAbs();
    const Vector3 a = 2.0 * drawn(random), b = 2.0 * drawn(random);
    accuracy::Smallest least;
    constexpr int kSamples = 1000;
    for (int k = 0; k <= kSamples; ++k) {
      const Vector3 point = box.T_L_box.inverse() * Vector3(a + (b - a) * k / kSamples);
      least.add((point.cwiseAbs() - box.half_m).cwiseMax(0.0).norm());
    }
    const double found = box_distance(a, b, box);
    EXPECT_NEAR(found, least, 0.004);  // half a step of the samples
    EXPECT_LE(found, least + 1e-6);
  }
}

}  // namespace

// What touches and what is hidden at postures where it can be seen from the drawing.

namespace {

TestbedDesign bench() {
  return read_testbed_design(tests::source_path("data/benches/tron.toml"));
}

Posture home() {
  const TestbedDesign file = bench();
  return {Joints::Map(file.camera_robot.home_rad.data()), Joints::Map(file.target_robot.home_rad.data()),
          file.track.home_m};
}

TEST(TronBodies, TheHomePostureIsFree) {
  const TestbedBodies bodies(bench());
  EXPECT_EQ(bodies.collision(bodies.at(home())), "");
}

TEST(TronBodies, NamesWhatTouches) {
  const TestbedBodies bodies(bench());
  Posture at = home();
  at.target_rad = Joints(0.0, 0.7, 0.5, 0.0, 0.0, 0.0);
  EXPECT_NE(bodies.collision(bodies.at(at)).find("the room"), std::string::npos);
  at = home();
  at.carriage_m = 6.9;  // the arms above one another, both stretched towards the middle of the room's height
  at.camera_rad = Joints(0.0, 1.5707 - 1.5707 + 0.7, 0.8, 0.0, 0.0, 0.0);
  at.target_rad = Joints(0.0, -1.5, 0.1, 0.0, 0.0, 0.0);
  EXPECT_NE(bodies.collision(bodies.at(at)), "");
  at = home();
  at.camera_rad[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(bodies.collision(bodies.at(at)).find("not finite"), std::string::npos);
  EXPECT_NE(bodies.collision_between(home(), at, 0.05), "");
}

TEST(TronBodies, TheRodHidesTheMiddleFromBehindOnly) {
  const TestbedBodies bodies(bench());
  const TestbedDesign file = bench();
  const std::vector<fsw::Vector3> middle{0.5 * (file.target.body_low_m + file.target.body_high_m)};
  Bodies at = bodies.at(home());
  const fsw::Vector3 ahead = at.T_L_T.linear().col(2);  // the flange's z goes into the body, which the bottom holds
  at.T_L_C.translation() = at.T_L_T * fsw::Vector3(0.0, 0.0, 2.0);
  EXPECT_EQ(bodies.hidden(at, middle), 0);
  at.T_L_C.translation() = at.T_L_T.translation() - 2.0 * ahead;
  EXPECT_EQ(bodies.hidden(at, middle), 1);
}

TEST(TronBodies, LitPointsAreOfTheFacesTowardsTheLamp) {
  OrientedBox hull;
  hull.T_L_box.translation() = fsw::Vector3(1.0, 2.0, 3.0);
  hull.half_m = fsw::Vector3(0.1, 0.2, 0.3);
  const auto one = TestbedBodies::lit_points(hull, -fsw::Vector3::UnitY());
  ASSERT_EQ(one.size(), 4U);
  for (const fsw::Vector3& point : one) {
    EXPECT_NEAR(point.y(), 1.8, 1e-12);
    EXPECT_NEAR(std::abs(point.x() - 1.0), 0.07, 1e-12);
    EXPECT_NEAR(std::abs(point.z() - 3.0), 0.21, 1e-12);
  }
  EXPECT_EQ(TestbedBodies::lit_points(hull, fsw::Vector3(0.6, 0.0, -0.8)).size(), 8U);
  EXPECT_EQ(TestbedBodies::lit_points(hull, fsw::Vector3(1.0, 1.0, 1.0).normalized()).size(), 12U);
}

// Light along the rod: from behind, wrist and forearm stand before the face that the rod holds.
TEST(TronBodies, AnArmShadesWhatItStandsBefore) {
  const TestbedBodies bodies(bench());
  const Bodies at = bodies.at(home());
  const fsw::Vector3 ahead = at.T_L_T.linear().col(2);
  EXPECT_EQ(bodies.shaded(at, ahead), 0);
  const fsw::Vector3 point = at.T_L_T * fsw::Vector3(0.0, 0.03, 0.0), aside = at.T_L_T * fsw::Vector3(0.0, 0.12, 0.0);
  EXPECT_EQ(bodies.shaded_by(at.target_arm, -ahead, std::vector{point, aside, point}), 0b101U);
  EXPECT_EQ(bodies.shaded_by(at.target_arm, ahead, std::vector{point}), 0U);
  EXPECT_EQ(bodies.shaded_by(at.camera_arm, -ahead, std::vector{point}), 0U);
}

TEST(TronBodies, ThePointsAreElevenKeypointsAndTheMiddle) {
  const TestbedBodies bodies(bench());
  EXPECT_EQ(bodies.points_to_see(tests::source_path("data")).size(), 12U);
}

}  // namespace

}  // namespace vbar::tron
