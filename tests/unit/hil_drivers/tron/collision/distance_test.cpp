// Distances against sampled ones, and cases that can be worked out.

#include "hil_drivers/tron/collision/distance.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/figures.h"

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
}  // namespace vbar::tron
