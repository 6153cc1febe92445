// Light of the display on the detector, against photometry and against an integration in double precision.

#include "emulators/optical_stimulator/light_path.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "emulators/optical_stimulator/optical_path.h"
#include "host_sim/twins/camera/photometry.h"
#include "tests/support/figures.h"
#include "tests/unit/emulators/optical_stimulator/bench_fixture.h"

namespace vbar::optical_stimulator::bench {

namespace {

using test::Frame;
using test::Light;
using test::Moments;
using twins::camera::PhotonImage;
using twins::camera::Region;

constexpr Region kMiddle{710, 200, 500, 800};

TEST(DisplayLight, FollowsTheFormula) {
  const DisplayLight light;
  EXPECT_EQ(light.luminance(0.0), 0.0);
  EXPECT_EQ(light.luminance(3.0), 0.0);
  EXPECT_NEAR(light.luminance(255.0), 200.0, 1e-12);
  EXPECT_NEAR(light.luminance(129.0), 200.0 * std::pow(0.5, 2.2), 1e-9);
  EXPECT_NEAR(light.black_luminance(), 2e-3, 1e-15);
}

TEST(LightPath, AFullPixelIsAStarOfMagnitudeMinus086) {
  BenchSettings settings = test::perfect_bench();
  settings.light.contrast = 1e12;
  Light bench(settings);
  Frame frame(settings);
  frame.at(960, 600) = 255;
  const Moments moments = test::moments_of(bench.expose(frame.counts, kMiddle));
  const double lux = 200.0 * std::pow(9.6e-3 / (400.0 / 7.0), 2);
  const double magnitude = -2.5 * std::log10(lux / 2.54e-6);
  EXPECT_NEAR(magnitude, -0.86, 0.02);  // of 34.5 arcsec; the pixel has 34.65
  // The twin's own photometry of that star.
  const double electrons = twins::camera::star_photons(bench.camera.zero_magnitude_photons, magnitude, 0.0) * 0.2 *
                           bench.camera.electrons_per_photon_m2();
  EXPECT_NEAR(moments.sum / electrons, 1.0, 1e-4);
  EXPECT_NEAR(moments.sum, 2.4e6, 0.12e6);  // the design, for 34.5 arcsec, to two digits
}

TEST(LightPath, BlackLevelOfContrast1e5Is24Electrons) {
  const BenchSettings settings = test::perfect_bench();
  Light bench(settings);
  const PhotonImage image = bench.expose(Frame(settings).counts, kMiddle);
  EXPECT_NEAR(image.electrons[400 * 500 + 250], 24.0, 1.2);  // as above
}

TEST(LightPath, NoBlackLevelBesideTheDisplay) {
  const BenchSettings settings = test::default_bench();
  Light bench(settings);
  const PhotonImage image = bench.expose(Frame(settings).counts, {0, 0, 1920, 1200});
  // The display is displaced by 13.5 px to the right of the camera's field.
  EXPECT_EQ(image.electrons[600 * 1920], 0.0F);
  EXPECT_GT(image.electrons[600 * 1920 + 100], 15.0F);
}

/// A lit pixel on the detector by brute force: two Gaussians, integrated over each pixel on a grid of 40 x 40 points.
PhotonImage integrated(double electrons, const SeenPixel& seen, const Region& region) {
  PhotonImage image{region, {}};
  constexpr int kPoints = 40;
  const double sigma = seen.sigma_px, norm = 1.0 / (2.0 * std::numbers::pi * sigma * sigma * kPoints * kPoints);
  for (int y = region.y; y < region.y + region.height; ++y) {
    for (int x = region.x; x < region.x + region.width; ++x) {
      double sum = 0.0;
      for (int j = 0; j < kPoints; ++j) {
        for (int i = 0; i < kPoints; ++i) {
          const fsw::Vector2 at(x - 0.5 + (i + 0.5) / kPoints, y - 0.5 + (j + 0.5) / kPoints);
          const fsw::Vector2 core = at - seen.pixel, coma = core - 4.0 * seen.coma_px;
          sum += 0.75 * std::exp(-0.5 * core.squaredNorm() / (sigma * sigma)) +
                 0.25 * std::exp(-0.5 * coma.squaredNorm() / (sigma * sigma));
        }
      }
      image.electrons.push_back(static_cast<float>(electrons * norm * sum));
    }
  }
  return image;
}

TEST(LightPath, APixelIsSpreadAsAnIntegrationInDoublePrecision) {
  BenchSettings settings = test::default_bench();
  settings.light.pixel_unevenness = 0.0;
  settings.light.contrast = 1e12;
  Light bench(settings);
  bench.camera.optics.halo_fraction = 0.0;
  twins::camera::CameraSettings camera = bench.camera;
  LightPath path({1920, 1200, settings.light, camera, 1}, bench.optics);
  for (const auto& [u, v] : {std::pair{960, 600}, {40, 30}, {1700, 1100}, {700, 900}}) {
    Frame frame(settings);
    frame.at(u, v) = 200;
    const SeenPixel seen = bench.optics.seen(u, v);
    const Region region{static_cast<int>(seen.pixel.x()) - 12, static_cast<int>(seen.pixel.y()) - 12, 25, 25};
    PhotonImage image{region, {}};
    const ShownFrame shown{frame.counts, 1.0};
    path.expose({&shown, 1}, 0.2, 1.0, image);
    const double electrons = settings.light.luminance(200.0) * seen.solid_angle * seen.transmitted * 0.2 *
                             photons_per_lux(camera.zero_magnitude_photons) * camera.electrons_per_photon_m2();
    const PhotonImage expected = integrated(electrons, seen, region);
    accuracy::Largest difference;
    for (std::size_t k = 0; k < expected.electrons.size(); ++k)
      difference.add(std::abs(static_cast<double>(image.electrons[k] - expected.electrons[k])) / electrons);
    // Widths in steps of 0.01 px change the peak by up to 0.2 %; weights are interpolated to 1e-4.
    EXPECT_LE(difference, 1e-3) << u << ", " << v;
    const Moments a = test::moments_of(image), b = test::moments_of(expected);
    EXPECT_NEAR(a.sum / electrons, 1.0, 1e-4);
    EXPECT_NEAR(a.x, b.x, 1e-3);
    EXPECT_NEAR(a.y, b.y, 1e-3);
    EXPECT_NEAR(a.x, seen.pixel.x() + seen.coma_px.x(), 1e-3);
    EXPECT_NEAR(a.y, seen.pixel.y() + seen.coma_px.y(), 1e-3);
  }
}

TEST(LightPath, ComaIsFiveHundredthsOfAPixelAtTheCorner) {
  const Light bench(test::default_bench());
  const fsw::Vector2 corner(0.0, 0.0);
  const auto place = bench.optics.display_pixel(corner);
  EXPECT_NEAR(bench.optics.seen(place.x(), place.y()).coma_px.norm(), 0.05, 1e-3);
}

TEST(LightPath, AFrameThatIsLitAllOverHasTheLightOfItsSolidAngle) {
  BenchSettings settings = test::perfect_bench();
  settings.light.contrast = 1e12;
  Light bench(settings);
  Frame frame(settings);
  frame.counts.assign(frame.counts.size(), 255);
  const PhotonImage image = bench.expose(frame.counts, {900, 540, 120, 120});
  const double per_pixel = 200.0 / std::pow(bench.camera.focal_length_px(), 2) * 0.2 *
                           photons_per_lux(bench.camera.zero_magnitude_photons) *
                           bench.camera.electrons_per_photon_m2();
  // The halo takes 1 % and loses what falls beside this small region.
  EXPECT_NEAR(image.electrons[60 * 120 + 60] / per_pixel, 1.0, 5e-3);
}

TEST(LightPath, RegionsOfOneExposureAgree) {
  const BenchSettings settings = test::default_bench();
  Light bench(settings);
  bench.camera.optics.halo_fraction = 0.0;
  LightPath path({1920, 1200, settings.light, bench.camera, 1}, bench.optics);
  Frame frame(settings);
  for (int k = 0; k < 300; ++k)
    frame.at(600 + 7 * k % 800, 100 + 13 * k % 1000) = static_cast<std::uint8_t>(40 + k % 200);
  const ShownFrame shown{frame.counts, 1.0};
  PhotonImage whole{{0, 0, 1920, 1200}, {}}, part{kMiddle, {}};
  path.expose({&shown, 1}, 0.2, 1.0, whole);
  path.expose({&shown, 1}, 0.2, 1.0, part);
  accuracy::Largest difference;
  for (int y = kMiddle.y; y < kMiddle.y + kMiddle.height; ++y)
    for (int x = kMiddle.x; x < kMiddle.x + kMiddle.width; ++x)
      difference.add(std::abs(static_cast<double>(whole.at(x, y) - part.at(x, y))) /
                     (1.0 + static_cast<double>(part.at(x, y))));
  EXPECT_LE(difference, 1e-4);  // the black level is interpolated between nodes of its region
}

TEST(LightPath, TwoPicturesOfAnExposureAddUp) {
  const BenchSettings settings = test::default_bench();
  Light bench(settings);
  Frame first(settings), second(settings);
  first.at(960, 500) = 255;
  second.at(960, 700) = 255;
  const ShownFrame shown[2] = {{first.counts, 0.25}, {second.counts, 0.75}};
  PhotonImage both{kMiddle, {}};
  bench.path.expose(shown, 0.2, 1.0, both);
  const PhotonImage a = bench.expose(first.counts, kMiddle), b = bench.expose(second.counts, kMiddle);
  for (std::size_t k = 0; k < both.electrons.size(); k += 97)
    EXPECT_NEAR(both.electrons[k], 0.25F * a.electrons[k] + 0.75F * b.electrons[k], 1e-3F * (1.0F + both.electrons[k]));
}

TEST(Halo, KeepsLightAndPlaceAndHasTheWidth) {
  PhotonImage image{{0, 0, 101, 101}, std::vector<float>(101 * 101, 0.0F)};
  image.at(50, 50) = 1e6F;
  std::vector<float> work;
  spread_halo(0.01, 4.0, image, work);
  image.at(50, 50) -= 0.99e6F;
  const Moments moments = test::moments_of(image);
  EXPECT_NEAR(moments.sum, 1e4, 10.0);
  EXPECT_NEAR(moments.x, 50.0, 0.51);  // blocks of 4: up to half a block
  double variance = 0.0;
  for (int y = 0; y < 101; ++y)
    for (int x = 0; x < 101; ++x) variance += image.at(x, y) * std::pow(x - moments.x, 2);
  EXPECT_NEAR(std::sqrt(variance / moments.sum), 4.0, 0.15);
}

}  // namespace

// The bench's detector: the same pixels in every region, settings that take effect, noise by the number of the
// exposure.

namespace {

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
