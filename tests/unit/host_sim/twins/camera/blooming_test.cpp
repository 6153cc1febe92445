// Where the charge of full pixels goes.

#include "host_sim/twins/camera/blooming.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

namespace vbar::twins::camera {
namespace {

constexpr int kSide = 41;
constexpr std::size_t kMiddle = 20 * kSide + 20;

std::vector<float> dark() {
  return std::vector<float>(kSide * kSide, 0.0F);
}

double total(const std::vector<float>& charge) {
  return std::accumulate(charge.begin(), charge.end(), 0.0);
}

TEST(Blooming, BelowTheFullWellNothingMoves) {
  std::vector<float> charge = dark();
  charge[kMiddle] = 100.0F;
  charge[0] = 99.0F;
  const std::vector<float> before = charge;
  EXPECT_EQ(bloom({100.0, 0.5}, kSide, kSide, charge), 0.0);
  EXPECT_EQ(charge, before);
}

// 1000 electrons too many, a fifth of which spills: 50 to each neighbour, 800 are drained.
TEST(Blooming, SpillsEvenlyToFourNeighbours) {
  std::vector<float> charge = dark();
  charge[kMiddle] = 1100.0F;
  EXPECT_FLOAT_EQ(static_cast<float>(bloom({100.0, 0.2}, kSide, kSide, charge)), 800.0F);
  EXPECT_EQ(charge[kMiddle], 100.0F);
  for (const std::size_t neighbour : {kMiddle - 1, kMiddle + 1, kMiddle - kSide, kMiddle + kSide})
    EXPECT_FLOAT_EQ(charge[neighbour], 50.0F);
  EXPECT_EQ(charge[kMiddle + kSide + 1], 0.0F);
}

TEST(Blooming, ConservesCharge) {
  for (const double fraction : {0.0, 0.02, 0.5, 0.97, 1.0}) {
    std::vector<float> charge = dark();
    for (std::size_t k = 0; k < charge.size(); ++k) charge[k] = static_cast<float>(k % 90);
    charge[kMiddle] = 3e4F;
    charge[kMiddle + 3] = 7e3F;
    charge[kSide - 1] = 5e3F;  // a corner
    const double before = total(charge);
    const double drained = bloom({100.0, fraction}, kSide, kSide, charge);
    // Single precision: 2^-24 of 3e4 a share at most, in some thousand shares.
    EXPECT_NEAR(total(charge) + drained, before, 2.0) << fraction;
    EXPECT_THAT(charge, testing::Each(testing::Le(100.0F))) << fraction;
    EXPECT_GT(drained, 0.0) << fraction;
  }
}

// All spills and nothing is drained: the charge fills as many pixels as it needs, in a diamond whose four corners lie
// equally far out.
TEST(Blooming, WithoutADrainTheSpotGrowsTheSameWayEveryWhere) {
  std::vector<float> charge = dark();
  charge[kMiddle] = 100.0F * 61.0F;
  const double drained = bloom({100.0, 1.0}, kSide, kSide, charge);
  EXPECT_NEAR(total(charge) + drained, 6100.0, 0.1);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const float here = charge[static_cast<std::size_t>(y * kSide + x)];
      // But for the rounding of sums in another order.
      EXPECT_NEAR(here, charge[static_cast<std::size_t>(y * kSide + kSide - 1 - x)], 1e-3);
      EXPECT_NEAR(here, charge[static_cast<std::size_t>(x * kSide + y)], 1e-3);
    }
  }
  EXPECT_EQ(charge[kMiddle + 3], 100.0F);
}

TEST(Blooming, OverTheEdgeIsLost) {
  std::vector<float> charge = dark();
  charge[0] = 500.0F;
  const double drained = bloom({100.0, 1.0}, kSide, kSide, charge);
  EXPECT_EQ(charge[1], 100.0F);
  EXPECT_EQ(charge[kSide], 100.0F);
  EXPECT_EQ(drained, 200.0);
}

}  // namespace
}  // namespace vbar::twins::camera
