#include "hil_drivers/tron/bench/world/vicon_visibility.h"

#include <gtest/gtest.h>

#include "host_sim/mission/data_directory.h"

namespace vbar::tron::bench {
namespace {

using fsw::Vector3;

ViconVisibility cameras() {
  return ViconVisibility(read_bench_file(mission::data_directory() / "benches" / "tron.toml"));
}

Eigen::Isometry3d at(double x, double y, double z) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = Vector3(x, y, z);
  return T;
}

TEST(ViconVisibility, SegmentsThroughABallOfKnownPlace) {
  const Capsule capsule{{0.0, 0.0, -1.0}, {0.0, 0.0, 1.0}, 0.1};
  EXPECT_TRUE(crosses({-1.0, 0.09, 0.0}, {1.0, 0.09, 0.0}, capsule));
  EXPECT_FALSE(crosses({-1.0, 0.11, 0.0}, {1.0, 0.11, 0.0}, capsule));
  EXPECT_TRUE(crosses({-1.0, 0.0, 1.09}, {1.0, 0.0, 1.09}, capsule));
  EXPECT_FALSE(crosses({-1.0, 0.0, 1.11}, {1.0, 0.0, 1.11}, capsule));
  EXPECT_FALSE(crosses({-1.0, 0.0, 0.0}, {-0.2, 0.0, 0.0}, capsule));
}

TEST(ViconVisibility, SegmentsThroughABlock) {
  const Block block{at(1.0, 2.0, 3.0), {-0.1, -0.2, -0.3}, {0.1, 0.2, 0.3}};
  EXPECT_TRUE(crosses({0.0, 2.19, 3.0}, {2.0, 2.19, 3.0}, block));
  EXPECT_FALSE(crosses({0.0, 2.21, 3.0}, {2.0, 2.21, 3.0}, block));
  EXPECT_FALSE(crosses({0.0, 2.0, 3.0}, {0.5, 2.0, 3.0}, block));
  EXPECT_FALSE(crosses({1.2, 2.0, 0.0}, {1.2, 2.0, 9.0}, block));
}

TEST(ViconVisibility, MarkersOfABoxInTheOpenAreSeenButForThoseThatFaceTheFloor) {
  const auto markers = markers_of_box({-0.15, -0.15, -0.1}, {0.15, 0.15, 0.1});
  EXPECT_EQ(markers.size(), 14U);
  const Block self{at(6.5, 0.0, 1.4), {-0.15, -0.15, -0.1}, {0.15, 0.15, 0.1}};
  const std::size_t located = cameras().located(self.T_L_block, markers, {}, {self});
  EXPECT_GE(located, 8U);
  EXPECT_LT(located, 14U);  // the lowest cannot see a ceiling
}

TEST(ViconVisibility, ABodyAroundTheObjectHidesIt) {
  const auto markers = markers_of_box({-0.05, -0.05, -0.05}, {0.05, 0.05, 0.05});
  const Capsule bag{{6.5, 0.0, 1.4}, {6.5, 0.0, 1.4}, 0.3};
  EXPECT_EQ(cameras().located(at(6.5, 0.0, 1.4), markers, {bag}, {}), 0U);
}

}  // namespace
}  // namespace vbar::tron::bench
