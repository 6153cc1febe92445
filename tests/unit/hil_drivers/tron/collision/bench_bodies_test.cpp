// What touches and what is hidden at postures where it can be seen from the drawing.

#include "hil_drivers/tron/collision/bench_bodies.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/paths.h"

namespace vbar::tron {
namespace {

BenchFile bench() {
  return read_bench_file(tests::source_path("data/benches/tron.toml"));
}

Posture home() {
  const BenchFile file = bench();
  return {Joints::Map(file.camera_robot.home_rad.data()), Joints::Map(file.target_robot.home_rad.data()),
          file.track.home_m};
}

TEST(TronBodies, TheHomePostureIsFree) {
  const BenchBodies bodies(bench());
  EXPECT_EQ(bodies.collision(bodies.at(home())), "");
}

TEST(TronBodies, NamesWhatTouches) {
  const BenchBodies bodies(bench());
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
  const BenchBodies bodies(bench());
  const BenchFile file = bench();
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
  const auto one = BenchBodies::lit_points(hull, -fsw::Vector3::UnitY());
  ASSERT_EQ(one.size(), 4U);
  for (const fsw::Vector3& point : one) {
    EXPECT_NEAR(point.y(), 1.8, 1e-12);
    EXPECT_NEAR(std::abs(point.x() - 1.0), 0.07, 1e-12);
    EXPECT_NEAR(std::abs(point.z() - 3.0), 0.21, 1e-12);
  }
  EXPECT_EQ(BenchBodies::lit_points(hull, fsw::Vector3(0.6, 0.0, -0.8)).size(), 8U);
  EXPECT_EQ(BenchBodies::lit_points(hull, fsw::Vector3(1.0, 1.0, 1.0).normalized()).size(), 12U);
}

// Light along the rod: from behind, wrist and forearm stand before the face that the rod holds.
TEST(TronBodies, AnArmShadesWhatItStandsBefore) {
  const BenchBodies bodies(bench());
  const Bodies at = bodies.at(home());
  const fsw::Vector3 ahead = at.T_L_T.linear().col(2);
  EXPECT_EQ(bodies.shaded(at, ahead), 0);
  const fsw::Vector3 point = at.T_L_T * fsw::Vector3(0.0, 0.03, 0.0), aside = at.T_L_T * fsw::Vector3(0.0, 0.12, 0.0);
  EXPECT_EQ(bodies.shaded_by(at.target_arm, -ahead, std::vector{point, aside, point}), 0b101U);
  EXPECT_EQ(bodies.shaded_by(at.target_arm, ahead, std::vector{point}), 0U);
  EXPECT_EQ(bodies.shaded_by(at.camera_arm, -ahead, std::vector{point}), 0U);
}

TEST(TronBodies, ThePointsAreElevenKeypointsAndTheMiddle) {
  const BenchBodies bodies(bench());
  EXPECT_EQ(bodies.points_to_see(tests::source_path("data")).size(), 12U);
}

}  // namespace
}  // namespace vbar::tron
