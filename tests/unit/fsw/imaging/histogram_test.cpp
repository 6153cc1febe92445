// Clipped moments against the numbers that samples were drawn with.

#include "fsw/imaging/histogram.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace vbar::fsw::imaging {
namespace {

/// Rounded normal numbers; a part of them is anything between the mean and 400 above it, as stars are.
ClippedMoments of_normal(double mean, double sigma, double stars, int samples) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal(mean, sigma);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<std::uint16_t> counts(1000);
  for (int k = 0; k < samples; ++k) {
    const double x = normal(random) + (uniform(random) < stars ? 400.0 * uniform(random) : 0.0);
    ++counts[static_cast<std::size_t>(std::lround(x))];
  }
  return clipped_moments(counts, samples);
}

/// Rounding to whole numbers adds a variance of 1/12 (Sheppard). 40,000 samples: 1 sigma of the mean is 0.005 sigma, of
/// sigma 0.0035; the bounds are four of those and, for sigma, what clipping at whole numbers adds: half a per cent, and
/// two below a sigma of 0.9.
TEST(ClippedMoments, OfARoundedGaussian) {
  for (const double sigma : {0.6, 0.93, 2.0, 8.0, 25.0}) {
    for (const double mean : {200.0, 200.25, 200.5}) {
      const ClippedMoments m = of_normal(mean, sigma, 0.0, 40000);
      const double expected = std::sqrt(sigma * sigma + 1.0 / 12.0);
      EXPECT_NEAR(m.mean, mean, 0.02 * expected);
      EXPECT_NEAR(m.sigma, expected, (sigma < 0.9 ? 0.034 : 0.019) * expected);
    }
  }
}

/// Half a per cent of a field's pixels in stars: they move the mean of all by one DN, the clipped one by hundredths.
TEST(ClippedMoments, StarsDoNotCount) {
  const ClippedMoments m = of_normal(64.0, 0.93, 0.005, 40000);
  EXPECT_NEAR(m.mean, 64.0, 0.03);
  EXPECT_NEAR(m.sigma, std::sqrt(0.93 * 0.93 + 1.0 / 12.0), 0.03);
}

TEST(ClippedMoments, OfOneValueIsItsRounding) {
  std::vector<std::uint16_t> counts(10);
  counts[7] = 100;
  const ClippedMoments m = clipped_moments(counts, 100);
  EXPECT_DOUBLE_EQ(m.mean, 7.0);
  EXPECT_DOUBLE_EQ(m.sigma, std::sqrt(1.0 / 12.0));
}

}  // namespace
}  // namespace vbar::fsw::imaging
