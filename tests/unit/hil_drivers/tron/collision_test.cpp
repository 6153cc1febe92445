#include "hil_drivers/tron/geometry/collision.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/figures.h"
#include "tests/support/paths.h"

namespace vbar::tron {

namespace {

TestbedDesign bench() {
  return read_testbed_design(tests::source_path("data/benches/tron.toml"));
}

}  // namespace

// Distances against sampled ones, and cases that can be worked out.

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

/// A segment, a second one, a box (middle, rotation vector, half edges), and the distances of the first segment from
/// both.
struct ReferenceDistances {
  Vector3 from, to, other_from, other_to, middle, rotation, half;
  double segments_m, box_m;
};

/// By the Flexible Collision Library (Debian's libfcl-dev 0.7.0): fcl::distance of capsules of radius 0.01 m from each
/// other and from a box, tolerance 1e-9, plus the radii. Coordinates of std::mt19937_64 with seed 20240817, uniform
/// within 1.5 m (components of the rotation vector within 2 rad, half edges 0.1 to 0.5 m), rounded to 1 mm; cases in
/// which nothing touches.
// clang-format off
const std::array<ReferenceDistances, 24> kReferences{{
    {{1.1, 0.454, 1.385}, {-0.209, -0.145, -0.954}, {1.273, 1.029, 0.294}, {1.313, -1.109, -0.363},
     {-0.643, -0.809, -0.136}, {-1.815, 0.392, 0.646}, {0.494, 0.324, 0.197}, 0.806473380851, 0.556095249325},
    {{0.265, -0.937, 1.316}, {-1.44, 0.377, -1.23}, {1.291, 0.627, -1.194}, {-1.089, -0.558, -0.154},
     {0.72, 0.012, 0.913}, {0.02, 1.423, 0.445}, {0.318, 0.421, 0.378}, 0.248384893125, 0.426280822915},
    {{0.01, -0.2, 1.468}, {1.321, -0.309, -0.549}, {0.962, -1.209, -1.452}, {0.329, -0.778, 0.039},
     {0.317, -1.496, -0.161}, {1.934, 0.112, -1.325}, {0.238, 0.23, 0.169}, 0.725925814904, 1.097793017910},
    {{0.484, -1.42, 1.007}, {-1.339, 0.747, -0.934}, {0.112, 0.378, 0.271}, {0.978, -1.249, 0.236},
     {0.516, -1.496, 0.054}, {0.908, 0.146, 1.334}, {0.271, 0.208, 0.397}, 0.713827516232, 0.465637616379},
    {{-1.397, -0.544, -0.776}, {-0.263, -1.477, 0.28}, {1.253, -0.239, 0.6}, {0.473, 0.928, 0.32},
     {0.885, -0.049, 0.803}, {-1.66, 1.152, 1.391}, {0.358, 0.306, 0.183}, 1.983254900413, 1.450333089712},
    {{-1.006, 0.857, -1.251}, {-0.375, 0.503, 0.371}, {-0.057, -1.041, -1.331}, {0.688, 0.608, -0.421},
     {1.36, 1.037, 1.301}, {-1.93, 0.988, -1.455}, {0.358, 0.358, 0.277}, 1.247111126103, 1.555562994955},
    {{0.53, 1.224, 0.876}, {-0.883, -0.307, -0.762}, {0.452, -0.131, -0.249}, {-0.984, -0.332, -0.489},
     {-0.865, -0.339, 0.181}, {1.934, 1.616, -0.509}, {0.393, 0.18, 0.383}, 0.207622189345, 0.267786858677},
    {{0.044, 1.106, -0.615}, {-1.115, 0.449, 0.295}, {-0.768, 1.015, 0.521}, {0.149, -0.377, 0.581},
     {-0.557, 0.701, 1.003}, {-1.658, 0.469, -0.986}, {0.166, 0.385, 0.482}, 0.534793919433, 0.351405064187},
    {{0.222, 0.461, -0.421}, {0.865, 1.106, 0.508}, {-0.747, -1.328, -0.474}, {-0.137, -0.532, -1.169},
     {-1.37, -0.649, -0.001}, {1.476, 0.09, 1.469}, {0.399, 0.482, 0.446}, 1.293999227280, 1.321457733931},
    {{-1.078, -0.968, -0.4}, {0.076, -0.902, -1.065}, {0.433, -0.445, 1.39}, {0.449, 1.432, -0.526},
     {-1.087, 0.155, -0.761}, {-1.68, -0.26, 1.627}, {0.167, 0.18, 0.229}, 2.046369328719, 0.838556577077},
    {{-0.768, 0.252, -0.285}, {-1.139, 0.755, 0.294}, {-0.98, -0.12, 1.155}, {-0.779, -1.131, 0.802},
     {-0.82, -0.27, -0.131}, {-0.709, 1.832, 0.681}, {0.386, 0.235, 0.276}, 1.237831394309, 0.193308721568},
    {{-1.15, -1.302, 0.744}, {0.729, 0.377, 0.858}, {1.259, -1.112, -0.1}, {-0.862, 1.145, 0.933},
     {0.759, -0.972, 1.108}, {0.91, 0.152, 0.26}, {0.39, 0.127, 0.105}, 0.417878594411, 0.795100133327},
    {{1.445, -1.032, 1.314}, {0.059, 1.156, -1.373}, {1.071, 1.027, 0.77}, {-1.17, 1.005, 0.524},
     {-1.332, 0.529, -0.733}, {-1.599, 1.479, -0.327}, {0.179, 0.167, 0.385}, 1.223649616670, 1.199417030726},
    {{1.419, 0.393, 0.596}, {0.241, 1.302, -0.913}, {-0.312, -1.125, -0.167}, {0.691, -1.44, 1.404},
     {-0.48, -0.545, 0.479}, {-1.922, -0.207, -0.831}, {0.498, 0.161, 0.45}, 2.047883727259, 1.388213001280},
    {{0.371, 1.199, 0.174}, {-0.736, 0.598, 1.391}, {-1.24, 0.597, 1.193}, {0.002, 1.231, 0.394},
     {-1.376, 1.266, 1.063}, {0.97, 1.221, 1.921}, {0.361, 0.207, 0.249}, 0.211855959634, 0.507040738995},
    {{0.325, -0.176, 0.335}, {0.061, 1.042, -0.094}, {-1.498, -1.376, 1.499}, {-0.644, -0.208, -1.328},
     {-0.313, 1.5, -0.913}, {0.304, 0.309, 0.635}, {0.304, 0.113, 0.342}, 1.498690395348, 0.639853082159},
    {{-0.708, 1.45, -0.089}, {1.401, 1.39, -0.181}, {0.524, -0.379, -1.491}, {-0.1, 1.304, -0.42},
     {-0.534, -0.347, -1.005}, {0.013, 0.039, 1.963}, {0.412, 0.303, 0.142}, 0.330128172608, 1.502392321948},
    {{1.146, 0.992, -1.342}, {0.516, 0.753, 0.72}, {1.113, -1.395, 0.89}, {-0.503, 1.31, -0.198},
     {0.782, -0.684, 1.407}, {-0.3, 0.929, -0.818}, {0.486, 0.4, 0.368}, 0.730126606005, 0.940679750240},
    {{0.424, 0.22, 0.694}, {-0.803, -0.864, -0.867}, {0.126, 1.172, -1.265}, {0.856, 1.116, 0.276},
     {-1.258, -1.207, -0.714}, {-1.209, 1.914, -0.018}, {0.345, 0.308, 0.353}, 1.078964318247, 0.180940937206},
    {{-1.003, -0.537, -0.692}, {-0.968, -0.124, 0.729}, {-0.967, 1.005, 0.787}, {-0.386, -1.44, 1.347},
     {-0.74, 0.92, 0.905}, {-1.941, -1.549, -1.705}, {0.263, 0.33, 0.147}, 0.394888364894, 0.777821119736},
    {{-0.755, 0.706, -1.288}, {-0.784, -0.786, -0.719}, {0.083, 0.041, -0.33}, {-0.337, -0.87, -1.205},
     {0.799, -0.873, 0.074}, {-0.752, -1.156, 1.221}, {0.393, 0.194, 0.112}, 0.582591846843, 1.557354412387},
    {{0.522, -0.184, 0.887}, {0.245, 1.149, -0.612}, {-0.071, -1.039, -0.064}, {-1.348, 1.225, -0.567},
     {0.149, -1.391, -0.657}, {-0.115, -1.462, -0.853}, {0.302, 0.324, 0.252}, 1.213532850434, 1.507909609877},
    {{-0.814, 0.476, 0.594}, {-0.457, 0.066, 0.871}, {-1.232, -0.416, -0.659}, {-0.885, -0.854, 1.245},
     {-1.379, -1.112, 0.964}, {0.35, 0.242, -0.64}, {0.172, 0.299, 0.222}, 0.965505617822, 1.150058174871},
    {{-0.161, -1.209, -0.086}, {-0.38, 0.543, -0.876}, {-1.445, 0.544, 1.352}, {-0.925, 1.202, 1.233},
     {0.88, -1.261, -0.714}, {-1.031, 1.242, 0.621}, {0.14, 0.319, 0.137}, 2.266542001801, 0.877756173091},
}};
// clang-format on

TEST(TronDistance, AreThoseOfTheFlexibleCollisionLibrary) {
  for (const ReferenceDistances& reference : kReferences) {
    // FCL's iteration ends within 2e-8 of the closed form in these cases.
    EXPECT_NEAR(segment_distance(reference.from, reference.to, reference.other_from, reference.other_to),
                reference.segments_m, 1e-7);
    OrientedBox box;
    box.T_L_box = Eigen::Translation3d(reference.middle) *
                  Eigen::AngleAxisd(reference.rotation.norm(), reference.rotation.normalized());
    box.half_m = reference.half;
    // The section ends within 5e-7 of a segment of at most 5.2 m.
    EXPECT_NEAR(box_distance(reference.from, reference.to, box), reference.box_m, 3e-6);
  }
}

}  // namespace

// What touches and what is hidden at postures where it can be seen from the drawing.

namespace {

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
