// Level and noise against those that an image was made with.

#include "fsw/vision/imaging/background.h"

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/figures.h"
#include "tests/support/synthetic_image.h"

namespace vbar::fsw::imaging {

namespace {

constexpr int kSaturation = 4000;

class BackgroundTest : public testing::Test {
 protected:
  ImageCondition measure(const test::SyntheticImage& scene) {
    width = scene.width();
    height = scene.height();
    pixels = scene.expose(detector, random);
    return measure_again();
  }
  ImageCondition measure_again() { return background->measure(test::view_of(pixels, width, height), kSaturation); }
  /// 1 sigma of a pixel that has so many electrons of light: light, dark current, read-out, rounding.
  [[nodiscard]] double expected_noise(double electrons) const {
    const double gain = detector.gain_dn_per_electron;
    const double read = detector.read_noise_electrons;
    return std::sqrt(gain * gain * (electrons + detector.dark_electrons + read * read) + 1.0 / 12.0);
  }
  /// Largest difference from the scene's own level, DN.
  double worst_level(test::SyntheticImage& scene) {
    accuracy::Largest worst;
    for (int y = 0; y < height; y += 7) {
      for (int x = 0; x < width; x += 7) {
        const double expected =
            detector.offset_dn + detector.gain_dn_per_electron * (scene.at(x, y) + detector.dark_electrons);
        worst.add(std::abs(background->level_dn(x, y) - expected));
      }
    }
    return worst;
  }

  test::SyntheticDetector detector;
  std::mt19937_64 random{1};
  std::unique_ptr<Background> background = std::make_unique<Background>();
  std::vector<std::uint16_t> pixels;
  int width = 0;
  int height = 0;
};

/// A cell has some 980 samples: 1 sigma of its level is 0.03 DN, of its noise 2 % (differences of pixels that do not
/// overlap: 3 %). Bounds for 104 cells: five of those, beyond the ends of the grid twice that.
TEST_F(BackgroundTest, OfADarkField) {
  test::SyntheticImage scene(500, 800);
  ASSERT_EQ(measure(scene), ImageCondition::kGood);
  EXPECT_LT(worst_level(scene), 0.2);
  EXPECT_NEAR(background->typical_level_dn(), 64.125, 0.02);
  EXPECT_NEAR(background->typical_noise_dn(), expected_noise(0.0), 0.02);
  for (int y = 0; y < 800; y += 31) EXPECT_NEAR(background->noise_dn((y * 7) % 500, y), expected_noise(0.0), 0.15);
}

TEST_F(BackgroundTest, AGradientIsFollowedToTheEdgesAndIsNotNoise) {
  test::SyntheticImage scene(500, 800);
  scene.add_light([](int x, int y) { return 4.0 * x + 2.0 * y; });
  ASSERT_EQ(measure(scene), ImageCondition::kGood);
  // Noise is 7.5 DN at the bright end; 1 sigma of a level 0.25 DN there
  EXPECT_LT(worst_level(scene), 2.5);
  // Between the outermost nodes, in the middle of their cells: beyond them it is theirs.
  for (const auto& [x, y] : {std::pair{31, 30}, {250, 400}, {468, 769}}) {
    const double expected = expected_noise(4.0 * x + 2.0 * y);
    EXPECT_NEAR(background->noise_dn(x, y), expected, 0.15 * expected);
  }
}

TEST_F(BackgroundTest, StarsAndAnObjectThatFillsACellAreNotBackground) {
  test::SyntheticImage scene(500, 800);
  ASSERT_EQ(measure(scene), ImageCondition::kGood);
  test::SyntheticImage crowded(500, 800);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int k = 0; k < 200; ++k) crowded.add({500.0 * uniform(random), 800.0 * uniform(random), 9000.0});
  crowded.add_light([](int x, int y) { return std::abs(x - 220) < 40 && std::abs(y - 330) < 40 ? 5000.0 : 0.0; });
  ASSERT_EQ(measure(crowded), ImageCondition::kGood);
  // The object is 625 DN high. The stars' own light leaves less than a tenth of a DN.
  EXPECT_LT(worst_level(scene), 0.5);
}

TEST_F(BackgroundTest, SmallAndNarrowImages) {
  for (const auto& [w, h] : {std::pair{8, 8}, {20, 500}, {4096, 97}, {97, 4096}, {100, 4000}, {632, 632}}) {
    test::SyntheticImage scene(w, h);
    ASSERT_EQ(measure(scene), ImageCondition::kGood) << w << " x " << h;
    EXPECT_LT(worst_level(scene), w < 10 ? 1.0 : 0.5);
  }
}

TEST_F(BackgroundTest, WholeRowsAndSinglePixelsAgree) {
  test::SyntheticImage scene(333, 200);
  scene.add_light([](int x, int y) { return 3.0 * x + 0.02 * y * y; });
  ASSERT_EQ(measure(scene), ImageCondition::kGood);
  std::vector<std::int32_t> row(333);
  for (const int y : {0, 57, 199}) {
    Background::RowNodes nodes;
    background->level_row(y, nodes);
    background->fill(nodes, row);
    for (int x = 0; x < 333; ++x) {
      EXPECT_NEAR(row[static_cast<std::size_t>(x)], background->level_dn(x, y) - 0.5, 0.52);
    }
  }
}

TEST_F(BackgroundTest, HalfAnImageIsEnough) {
  test::SyntheticImage scene(500, 800);
  ASSERT_EQ(measure(scene), ImageCondition::kGood);
  std::fill(pixels.begin(), pixels.begin() + 200'000, kMissingPixel);
  ASSERT_EQ(measure_again(), ImageCondition::kGood);
  EXPECT_NEAR(background->missing(), 50'000, 2000);  // every other pixel of every other row, from each cell's corner on
  EXPECT_LT(worst_level(scene), 0.4);
}

TEST_F(BackgroundTest, SaysWhenThereIsNothingToBeFound) {
  width = 500;
  height = 800;
  const auto condition_of = [&](std::uint16_t value) {
    pixels.assign(400'000, value);
    return measure_again();
  };
  EXPECT_EQ(condition_of(0), ImageCondition::kBlank);
  EXPECT_EQ(condition_of(64), ImageCondition::kBlank);
  EXPECT_EQ(condition_of(3999), ImageCondition::kBlank);
  EXPECT_EQ(condition_of(4000), ImageCondition::kSaturated);
  EXPECT_EQ(condition_of(4095), ImageCondition::kSaturated);
  EXPECT_EQ(condition_of(kMissingPixel), ImageCondition::kTooLittle);
  measure(test::SyntheticImage(500, 800));
  std::fill(pixels.begin(), pixels.begin() + 380'000, kMissingPixel);
  EXPECT_EQ(measure_again(), ImageCondition::kTooLittle);
  measure(test::SyntheticImage(500, 800));
  std::fill(pixels.begin(), pixels.begin() + 380'000, std::uint16_t{4090});
  EXPECT_EQ(measure_again(), ImageCondition::kSaturated);
}

TEST_F(BackgroundTest, RefusesWhatIsNoImage) {
  pixels.assign(100, 5);
  EXPECT_EQ(background->measure({}, kSaturation), ImageCondition::kInvalid);
  EXPECT_EQ(background->measure(test::view_of(pixels, 10, 11), kSaturation), ImageCondition::kInvalid);
  EXPECT_EQ(background->measure(test::view_of(pixels, -10, -10), kSaturation), ImageCondition::kInvalid);
  EXPECT_EQ(background->measure(test::view_of(pixels, 10, 10), 0), ImageCondition::kInvalid);
  EXPECT_EQ(background->measure(test::view_of(pixels, 10, 10), 4096), ImageCondition::kInvalid);
  pixels.assign(4097, 5);
  EXPECT_EQ(background->measure(test::view_of(pixels, 4097, 1), kSaturation), ImageCondition::kInvalid);
  pixels.assign(400'500, 5);
  EXPECT_EQ(background->measure(test::view_of(pixels, 500, 801), kSaturation), ImageCondition::kInvalid);
}

}  // namespace

// Clipped moments against the numbers that samples were drawn with.

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
