// A binned camera against sums of a single-pixel camera's own images: light, place of a point, noise.

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/detector.h"
#include "host_sim/twins/camera/optics.h"
#include "host_sim/twins/camera/point_spread.h"

namespace {

namespace camera = vbar::twins::camera;
using vbar::fsw::Vector2;
using vbar::fsw::Vector3;

camera::CameraSettings single_pixels() {
  camera::CameraSettings settings;
  settings.region = {800, 400, 320, 240};
  settings.optics.distortion = {-0.22, 0.51, -6e-4, -2e-4, -0.13};
  settings.optics.principal_point_px = {955.0, 603.0};
  settings.detector.hot_pixels = 0;
  return settings;
}

/// An image of the sums, out of one of single pixels.
std::vector<double> sums_of(const camera::CameraSettings& single, const auto& pixels, int binning) {
  const int width = single.region.width / binning;
  std::vector<double> sums(static_cast<std::size_t>(width * single.region.height / binning), 0.0);
  for (int y = 0; y < single.region.height; ++y)
    for (int x = 0; x < single.region.width; ++x)
      sums[static_cast<std::size_t>(y / binning * width + x / binning)] +=
          pixels[static_cast<std::size_t>(y * single.region.width + x)];
  return sums;
}

class Binning : public testing::TestWithParam<int> {};

TEST_P(Binning, APointFallsOnTheSumOfItsPixels) {
  const int binning = GetParam();
  const camera::CameraSettings single = single_pixels(), sums = camera::binned(single, binning);
  const Vector3 direction(0.005, -0.012, 1.0);
  const Vector2 on_single = *camera::Optics(single).project(direction),
                on_sums = *camera::Optics(sums).project(direction);
  EXPECT_NEAR((on_single - ((on_sums.array() + 0.5) * binning - 0.5).matrix()).norm(), 0.0, 1e-9);

  const auto image_of = [](const camera::CameraSettings& settings, const Vector2& place) {
    const camera::Region& region = settings.region;
    camera::PhotonImage image{region, std::vector<float>(static_cast<std::size_t>(region.width * region.height), 0.0F)};
    camera::PointSpread(settings.optics).add({place, 1e5}, Vector2::Zero(), image);
    return image;
  };
  const std::vector<double> expected = sums_of(single, image_of(single, on_single).electrons, binning);
  const camera::PhotonImage found = image_of(sums, on_sums);
  // Both cut off what lies beyond a reach of at least 3.3 halo sigmas, and not at the same edges.
  for (std::size_t k = 0; k < expected.size(); ++k) ASSERT_NEAR(found.electrons[k], expected[k], 2.0) << k;
}

// Mean and variance over many pixels of an even light; read noise and shot noise add.
TEST_P(Binning, NoiseIsThatOfSummedPixels) {
  const int binning = GetParam();
  camera::CameraSettings single = single_pixels();
  single.detector.photo_response_nonuniformity = 0.02;
  single.detector.read_noise_electrons = 20.0;
  single.detector.dark_electrons_per_s = 400.0;
  const camera::CameraSettings sums = camera::binned(single, binning);
  EXPECT_EQ(sums.region.x, single.region.x / binning);
  const auto electrons_of = [](const camera::CameraSettings& settings, double light, std::uint64_t seed) {
    camera::Detector detector(settings, seed, "camera");
    const std::size_t pixels = static_cast<std::size_t>(settings.region.width * settings.region.height);
    std::vector<std::uint16_t> dn;
    detector.expose({settings.region, std::vector<float>(pixels, static_cast<float>(light))}, 0, dn);
    std::vector<double> electrons(pixels);
    for (std::size_t k = 0; k < pixels; ++k)
      electrons[k] = (dn[k] - settings.detector.offset_dn) / settings.detector.gain_dn_per_electron;
    return electrons;
  };
  const auto moments = [](const std::vector<double>& values) {
    double sum = 0.0, squares = 0.0;
    for (const double v : values) sum += v;
    const double mean = sum / static_cast<double>(values.size());
    for (const double v : values) squares += (v - mean) * (v - mean);
    return std::pair(mean, squares / static_cast<double>(values.size()));
  };
  const double light = 4000.0, b2 = binning * binning;
  const auto [expected_mean, expected_variance] = moments(sums_of(single, electrons_of(single, light, 3), binning));
  const auto [mean, variance] = moments(electrons_of(sums, b2 * light, 4));
  const double samples = sums.region.width * sums.region.height;
  // Four standard deviations of the difference of two such figures; the rounding to numbers adds a little variance.
  EXPECT_NEAR(mean, expected_mean, 4.0 * std::sqrt(2.0 * variance / samples));
  EXPECT_NEAR(variance, expected_variance, (4.0 * std::sqrt(4.0 / samples) + 0.01) * variance);
}

TEST_P(Binning, AFullSumReadsWhatAFullPixelDoes) {
  const camera::CameraSettings single = single_pixels(), sums = camera::binned(single, GetParam());
  EXPECT_NEAR(sums.detector.full_well_electrons * sums.detector.gain_dn_per_electron,
              single.detector.full_well_electrons * single.detector.gain_dn_per_electron, 1e-9);
  EXPECT_NEAR(sums.focal_length_px() * GetParam(), single.focal_length_px(), 1e-9);
  EXPECT_NEAR(sums.electrons_per_photon_m2(), single.electrons_per_photon_m2(), 1e-15);
}

INSTANTIATE_TEST_SUITE_P(OneTwoFour, Binning, testing::Values(1, 2, 4));

}  // namespace
