// The bench's detector: the same pixels in every region, settings that take effect, noise by the number of the
// exposure.

#include "hil_drivers/optical_stimulator/bench/camera/camera_head.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/hil_drivers/optical_stimulator/bench/bench_fixture.h"

namespace vbar::optical_stimulator::bench {
namespace {

using twins::camera::PhotonImage;
using twins::camera::Region;

PhotonImage even(const Region& region, float electrons) {
  return {region, std::vector<float>(static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height),
                                     electrons)};
}

double mean_of(const std::vector<std::uint16_t>& dn) {
  double sum = 0.0;
  for (const std::uint16_t value : dn) sum += value;
  return sum / static_cast<double>(dn.size());
}

class CameraHeadTest : public ::testing::Test {
 protected:
  CameraHead camera{camera_of(test::default_bench(), mission::data_directory()), 5, true};
  std::vector<std::uint16_t> dn;
};

TEST_F(CameraHeadTest, MeanAndVarianceAreThoseOfItsGainAndNoise) {
  const PhotonImage image = even({700, 500, 300, 300}, 4000.0F);
  camera.expose(image, {0.2, 0.0, 66.0}, 1, dn);
  std::vector<std::uint16_t> other;
  camera.expose(image, {0.2, 0.0, 66.0}, 2, other);
  EXPECT_NEAR(mean_of(dn), 66.0 + 0.12875 * 4001.0, 1.0);  // a detector's mean response scatters by 0.5 % / 300
  double squares = 0.0;
  for (std::size_t k = 0; k < dn.size(); ++k) squares += std::pow(static_cast<double>(dn[k]) - other[k], 2);
  const double variance = 0.5 * squares / static_cast<double>(dn.size());
  const double expected = std::pow(0.12875, 2) * (4001.0 + 7.7 * 7.7) + 1.0 / 12.0;
  EXPECT_NEAR(variance / expected, 1.0, 0.03);  // 90,000 pixels: six sigma
}

TEST_F(CameraHeadTest, GainAndBlackLevelFollowTheSettings) {
  const PhotonImage image = even({700, 500, 100, 100}, 1000.0F);
  camera.expose(image, {0.2, 6.0, 100.0}, 1, dn);
  EXPECT_NEAR(mean_of(dn), 100.0 + 0.12875 * 1001.0 * std::pow(10.0, 0.3), 1.5);
}

TEST_F(CameraHeadTest, HotPixelsStandAtTheirPlacesInEveryRegion) {
  ASSERT_EQ(camera.hot_pixels().size(), 20U);
  for (const auto& hot : camera.hot_pixels()) {
    if (hot.electrons_per_s < 8000.0) continue;
    const int x = std::min(hot.x, 1919 - 32), y = std::min(hot.y, 1199 - 32);
    const Region region{x, y, 32, 32};
    camera.expose(even(region, 0.0F), {0.2, 0.0, 66.0}, 7, dn);
    const auto at = static_cast<std::size_t>((hot.y - y) * 32 + hot.x - x);
    EXPECT_NEAR(dn[at], 66.0 + 0.12875 * std::min(32000.0, 0.2 * hot.electrons_per_s), 0.05 * dn[at] + 10.0);
  }
}

TEST_F(CameraHeadTest, NoiseIsAFunctionOfTheNumber) {
  const PhotonImage image = even({0, 0, 64, 64}, 500.0F);
  camera.expose(image, {0.2, 0.0, 66.0}, 3, dn);
  std::vector<std::uint16_t> again;
  for (int k = 0; k < 10; ++k) camera.expose(image, {0.01 * k + 0.1, 0.0, 66.0}, 4, again);  // other settings between
  camera.expose(image, {0.2, 0.0, 66.0}, 3, again);
  EXPECT_EQ(dn, again);
  camera.expose(image, {0.2, 0.0, 66.0}, 4, again);
  EXPECT_NE(dn, again);
}

}  // namespace
}  // namespace vbar::optical_stimulator::bench
