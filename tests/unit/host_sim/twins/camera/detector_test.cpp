// The detector as a camera is characterised on a bench (EMVA standard 1288): from images of even light to gain, noise,
// dark current and saturation, against the settings it was made with.

#include "host_sim/twins/camera/detector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

namespace vbar::twins::camera {

namespace {

constexpr std::size_t kPixels = 200 * 100;

/// Fine steps of DN and none of the fixed pattern, unless a test sets some.
CameraSettings bench_camera() {
  CameraSettings settings;
  settings.region = {300, 400, 200, 100};
  settings.exposure_s = 0.5;
  settings.detector.gain_dn_per_electron = 0.5;
  settings.detector.bits = 12;
  settings.detector.offset_dn = 100.0;
  settings.detector.full_well_electrons = 7000.0;
  settings.detector.dark_electrons_per_s = 0.0;
  settings.detector.dark_nonuniformity = 0.0;
  settings.detector.photo_response_nonuniformity = 0.0;
  settings.detector.hot_pixels = 0;
  return settings;
}

PhotonImage even_light(const CameraSettings& settings, float electrons) {
  return {settings.region, std::vector<float>(static_cast<std::size_t>(settings.region.width) *
                                                  static_cast<std::size_t>(settings.region.height),
                                              electrons)};
}

std::vector<std::uint16_t> expose(const CameraSettings& settings, const PhotonImage& image, std::int64_t number = 0,
                                  std::uint64_t seed = 1) {
  Detector detector(settings, seed, "servicer/camera");
  std::vector<std::uint16_t> dn;
  detector.expose(image, number, dn);
  return dn;
}

struct Moments {
  double mean = 0.0, variance = 0.0;
};

/// Of many exposures: the mean over all pixels, the variance of each pixel from exposure to exposure.
Moments moments_of(const CameraSettings& settings, float electrons, int exposures) {
  Detector detector(settings, 1, "servicer/camera");
  const PhotonImage image = even_light(settings, electrons);
  std::vector<double> sum(image.electrons.size()), squares(image.electrons.size());
  std::vector<std::uint16_t> dn;
  for (int number = 0; number < exposures; ++number) {
    detector.expose(image, number, dn);
    for (std::size_t k = 0; k < dn.size(); ++k) {
      sum[k] += dn[k];
      squares[k] += static_cast<double>(dn[k]) * dn[k];
    }
  }
  Moments moments;
  const double n = exposures, pixels = static_cast<double>(sum.size());
  for (std::size_t k = 0; k < sum.size(); ++k) {
    moments.mean += sum[k] / n / pixels;
    moments.variance += (squares[k] - sum[k] * sum[k] / n) / (n - 1.0) / pixels;
  }
  return moments;
}

// variance = gain^2 (read noise^2 + electrons) + 1/12 of rounding: the slope over the mean is the gain. 200,000 values
// a point know a variance to 0.3 per cent, the slope of the whole curve to less.
TEST(Detector, PhotonTransferCurveGivesGainAndReadNoise) {
  const CameraSettings settings = bench_camera();
  std::vector<Moments> curve;
  for (const float electrons : {0.0F, 5.0F, 11.0F, 14.0F, 60.0F, 300.0F, 1000.0F, 3000.0F})
    curve.push_back(moments_of(settings, electrons, 10));
  EXPECT_NEAR(curve[0].mean, 100.0, 0.05) << "the offset";
  EXPECT_NEAR(std::sqrt(curve[0].variance - 1.0 / 12.0) / 0.5, 7.0, 0.05) << "read noise, electrons";
  for (std::size_t k = 5; k < curve.size(); ++k) {
    const double gain = (curve[k].variance - curve[0].variance) / (curve[k].mean - curve[0].mean);
    EXPECT_NEAR(gain, 0.5, 0.005) << k;
  }
  EXPECT_NEAR(curve[1].mean, 102.5, 0.05);
  EXPECT_NEAR(curve[7].mean, 1600.0, 0.3) << "linear";
  for (std::size_t k = 1; k < 5; ++k) {
    const double electrons = (curve[k].mean - 100.0) / 0.5;
    EXPECT_NEAR(curve[k].variance - curve[0].variance, 0.25 * electrons, 0.02 * (curve[0].variance + 0.25 * electrons))
        << k;
  }
}

TEST(Detector, DarkCurrentGrowsWithTheExposure) {
  CameraSettings settings = bench_camera();
  settings.detector.dark_electrons_per_s = 40.0;
  EXPECT_NEAR(moments_of(settings, 0.0F, 5).mean, 100.0 + 0.5 * 20.0, 0.06);
  settings.exposure_s = 2.0;
  EXPECT_NEAR(moments_of(settings, 0.0F, 5).mean, 100.0 + 0.5 * 80.0, 0.12);
}

/// Relative standard deviation over the pixels of what they are worth, noise averaged away and what is left of it
/// taken out.
double fixed_pattern(const CameraSettings& settings, float electrons, double signal_dn) {
  Detector detector(settings, 1, "servicer/camera");
  const PhotonImage image = even_light(settings, electrons);
  constexpr int kExposures = 40;
  std::vector<double> mean(kPixels);
  std::vector<std::uint16_t> dn;
  double noise = 0.0;
  for (int number = 0; number < kExposures; ++number) {
    detector.expose(image, number, dn);
    for (std::size_t k = 0; k < kPixels; ++k) mean[k] += dn[k] / static_cast<double>(kExposures);
  }
  noise = (0.25 * 49.0 + 0.5 * signal_dn + 1.0 / 12.0) / kExposures;
  double variance = 0.0;
  for (const double value : mean)
    variance += (value - 100.0 - signal_dn) * (value - 100.0 - signal_dn) / static_cast<double>(kPixels);
  return std::sqrt(variance - noise) / signal_dn;
}

TEST(Detector, PixelsDifferAsTheSettingsSay) {
  CameraSettings settings = bench_camera();
  settings.detector.photo_response_nonuniformity = 0.02;
  EXPECT_NEAR(fixed_pattern(settings, 4000.0F, 2000.0), 0.02, 0.0005);
  settings.detector.photo_response_nonuniformity = 0.0;
  settings.detector.dark_electrons_per_s = 4000.0;
  settings.detector.dark_nonuniformity = 0.1;
  EXPECT_NEAR(fixed_pattern(settings, 0.0F, 1000.0), 0.1, 0.002);
}

TEST(Detector, PatternBelongsToThePixelNotToTheRegion) {
  CameraSettings settings = bench_camera();
  settings.detector.photo_response_nonuniformity = 0.1;
  settings.detector.read_noise_electrons = 0.0;
  const auto whole = expose(settings, even_light(settings, 6000.0F));
  CameraSettings moved = settings;
  moved.region = {310, 420, 50, 40};
  const auto part = expose(moved, even_light(moved, 6000.0F));
  double difference = 0.0;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 50; ++x) {
      const double a = whole[static_cast<std::size_t>((y + 20) * 200 + x + 10)];
      const double b = part[static_cast<std::size_t>(y * 50 + x)];
      difference += std::abs(a - b) / 2000.0;
    }
  }
  // The pattern is 300 DN, shot noise of both together 55 DN; pixels of different patterns would differ by 340 DN.
  EXPECT_LT(difference, 60.0);
}

TEST(Detector, SaturatesAtTheFullWellAndAtTheConverter) {
  CameraSettings settings = bench_camera();
  for (const float electrons : {1e5F, 1e9F, std::numeric_limits<float>::infinity()}) {
    const auto dn = expose(settings, even_light(settings, electrons));
    double mean = 0.0;
    for (const std::uint16_t value : dn) mean += value / static_cast<double>(dn.size());
    EXPECT_NEAR(mean, 100.0 + 0.5 * 7000.0, 0.2) << "the full well, and read noise on it";
  }
  settings.detector.full_well_electrons = 9000.0;
  for (const std::uint16_t value : expose(settings, even_light(settings, 1e5F))) ASSERT_EQ(value, 4095);
  settings.detector.bits = 8;
  for (const std::uint16_t value : expose(settings, even_light(settings, 1e5F))) ASSERT_EQ(value, 255);
  settings.detector.offset_dn = -100.0;
  for (const std::uint16_t value : expose(settings, even_light(settings, 0.0F))) ASSERT_EQ(value, 0);
}

TEST(Detector, BloomingFeedsTheNeighboursOfABrightPoint) {
  CameraSettings settings = bench_camera();
  settings.detector.blooming_fraction = 0.1;
  PhotonImage image = even_light(settings, 0.0F);
  image.at(400, 450) = 47000.0F;
  Detector detector(settings, 1, "servicer/camera");
  std::vector<std::uint16_t> dn;
  detector.expose(image, 0, dn);
  const auto at = [&](int x, int y) { return dn[static_cast<std::size_t>((y - 400) * 200 + x - 300)]; };
  EXPECT_NEAR(at(400, 450), 3600, 20);
  EXPECT_NEAR(at(401, 450), 100 + 500, 25) << "40,000 electrons too many, a fortieth to each neighbour";
  EXPECT_NEAR(at(400, 449), 600, 25);
  EXPECT_NEAR(at(401, 449), 100, 20);
  EXPECT_NEAR(detector.drained_electrons(), 36000.0, 1000.0) << "shot noise of the 47,000 is 217";
}

TEST(Detector, HotPixelsStayWhereTheyAre) {
  CameraSettings settings = bench_camera();
  settings.detector.hot_pixels = 20;
  settings.detector.full_well_electrons = 1e6;
  Detector detector(settings, 5, "servicer/camera");
  const std::vector<HotPixel> hot(detector.hot_pixels().begin(), detector.hot_pixels().end());
  ASSERT_EQ(hot.size(), 20U);
  std::set<std::pair<int, int>> places;
  double sum = 0.0;
  for (const HotPixel& pixel : hot) {
    EXPECT_TRUE(pixel.x >= 300 && pixel.x < 500 && pixel.y >= 400 && pixel.y < 500);
    places.emplace(pixel.x, pixel.y);
    sum += pixel.electrons_per_s;
  }
  EXPECT_EQ(places.size(), 20U);
  EXPECT_NEAR(sum / 20.0, 20000.0, 3.0 * 20000.0 / std::sqrt(20.0)) << "mean of an exponential distribution";
  const PhotonImage dark = even_light(settings, 0.0F);
  for (const std::int64_t number : {0, 17}) {
    std::vector<std::uint16_t> dn;
    detector.expose(dark, number, dn);
    for (std::size_t k = 0; k < dn.size(); ++k) {
      const std::pair place(300 + static_cast<int>(k % 200), 400 + static_cast<int>(k / 200));
      const auto found = std::find_if(hot.begin(), hot.end(),
                                      [&](const HotPixel& pixel) { return std::pair(pixel.x, pixel.y) == place; });
      const double electrons = found == hot.end() ? 0.0 : 0.5 * found->electrons_per_s;
      // Six sigma and a half of 20,000 pixels; 4095 is the converter's end.
      ASSERT_NEAR(dn[k], std::min(100.0 + 0.5 * electrons, 4095.0), 0.5 + 3.2 * std::sqrt(electrons + 49.0) + 1e-9)
          << k;
    }
  }
  EXPECT_NE(std::make_pair(hot[0].x, hot[0].y),
            std::make_pair(Detector(settings, 6, "servicer/camera").hot_pixels()[0].x,
                           Detector(settings, 6, "servicer/camera").hot_pixels()[0].y))
      << "another seed, another detector";
}

double correlation(const std::vector<std::uint16_t>& a, const std::vector<std::uint16_t>& b, double mean) {
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    ab += (a[k] - mean) * (b[k] - mean);
    aa += (a[k] - mean) * (a[k] - mean);
    bb += (b[k] - mean) * (b[k] - mean);
  }
  return ab / std::sqrt(aa * bb);
}

TEST(Detector, NoiseIsAFunctionOfSeedCameraExposureAndPixel) {
  const CameraSettings settings = bench_camera();
  const PhotonImage image = even_light(settings, 100.0F);
  Detector detector(settings, 1, "servicer/camera");
  std::vector<std::uint16_t> first, later, again, next;
  detector.expose(image, 3, first);
  detector.expose(even_light(settings, 5000.0F), 4, later);
  detector.expose(image, 3, again);
  detector.expose(image, 4, next);
  EXPECT_EQ(first, again) << "whatever came between";
  EXPECT_EQ(first, expose(settings, image, 3));
  // Independent: a correlation of 20,000 pairs has a standard deviation of 0.007.
  EXPECT_LT(std::abs(correlation(first, next, 150.0)), 0.03) << "another exposure";
  EXPECT_LT(std::abs(correlation(first, expose(settings, image, 3, 2), 150.0)), 0.03) << "another seed";
  std::vector<std::uint16_t> other_camera;
  Detector(settings, 1, "target/camera").expose(image, 3, other_camera);
  EXPECT_LT(std::abs(correlation(first, other_camera, 150.0)), 0.03);
  std::vector<std::uint16_t> shifted(first.begin() + 1, first.end());
  shifted.push_back(first.front());
  EXPECT_LT(std::abs(correlation(first, shifted, 150.0)), 0.03) << "the neighbour";
  std::vector<std::uint16_t> of_same_block(first.begin() + 64, first.end());
  of_same_block.insert(of_same_block.end(), first.begin(), first.begin() + 64);
  EXPECT_LT(std::abs(correlation(first, of_same_block, 150.0)), 0.03) << "another word of the same block";
}

TEST(Detector, LightOfAPixelChangesNoOther) {
  const CameraSettings settings = bench_camera();
  PhotonImage image = even_light(settings, 3.0F);
  const auto before = expose(settings, image);
  image.at(350, 450) = 2000.0F;
  const auto after = expose(settings, image);
  const std::size_t place = 50 * 200 + 50;
  for (std::size_t k = 0; k < before.size(); ++k) {
    if (k == place) continue;
    ASSERT_EQ(before[k], after[k]) << k;
  }
  EXPECT_GT(after[place], before[place] + 800);
}

TEST(Detector, LightThatIsNoneCountsAsNone) {
  const CameraSettings settings = bench_camera();
  const auto dark = expose(settings, even_light(settings, 0.0F));
  EXPECT_EQ(expose(settings, even_light(settings, -5.0F)), dark);
  EXPECT_EQ(expose(settings, even_light(settings, std::numeric_limits<float>::quiet_NaN())), dark);
}

TEST(Detector, ImageOfAnotherRegionIsRefused) {
  const CameraSettings settings = bench_camera();
  PhotonImage image = even_light(settings, 0.0F);
  image.region.x += 1;
  EXPECT_THROW(expose(settings, image), std::invalid_argument);
  image = even_light(settings, 0.0F);
  image.electrons.pop_back();
  EXPECT_THROW(expose(settings, image), std::invalid_argument);
}

TEST(Detector, DarkCurrentIsThatOfTheDuration) {
  CameraSettings settings;
  settings.region = {0, 0, 200, 100};
  settings.exposure_s = 2.0;
  settings.detector.hot_pixels = 0;
  settings.detector.dark_electrons_per_s = 4000.0;
  Detector detector(settings, 5, "camera");
  const PhotonImage dark{settings.region, std::vector<float>(20000, 0.0F)};
  const auto mean_electrons = [&](std::optional<double> duration_s) {
    std::vector<std::uint16_t> dn;
    detector.expose(dark, 1, dn, duration_s);
    double sum = 0.0;
    for (const std::uint16_t value : dn) sum += value - settings.detector.offset_dn;
    return sum / static_cast<double>(dn.size()) / settings.detector.gain_dn_per_electron;
  };
  // 1 sigma of the mean: 10 % of pattern and shot noise over 20,000 pixels are below 6 electrons.
  EXPECT_NEAR(mean_electrons(std::nullopt), 8000.0, 30.0);
  EXPECT_NEAR(mean_electrons(2.0), 8000.0, 30.0);
  EXPECT_NEAR(mean_electrons(0.5), 2000.0, 10.0);
}

}  // namespace

// Where the charge of full pixels goes.

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
