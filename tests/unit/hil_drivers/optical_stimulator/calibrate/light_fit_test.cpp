// Fits of light and noise on synthetic measurements, and what dots are in linear light.

#include "hil_drivers/optical_stimulator/calibrate/light_fit.h"

#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "hil_drivers/optical_stimulator/calibrate/camera_noise.h"
#include "hil_drivers/optical_stimulator/calibrate/dots.h"
#include "tests/support/figures.h"

namespace vbar::optical_stimulator::calibrate {
namespace {

using fsw::Vector2;

std::vector<SquareLight> squares_of(double gamma, double first_count, double noise) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<SquareLight> squares;
  for (int place = 0; place < 9; ++place)
    for (const double count : {7.0, 8.0, 10.0, 13.0, 17.0, 23.0, 34.0, 57.0, 95.0, 150.0, 255.0}) {
      const double full = 1e7 * (1.0 + 0.03 * place);
      const double light = full * std::pow((count - first_count) / (255.0 - first_count), gamma);
      squares.push_back({place, count, light * (1.0 + noise * normal(random)), noise * light});
    }
  return squares;
}

TEST(ResponseFit, RecoversTheLawWithoutNoise) {
  const ResponseFit fit = fit_response(squares_of(2.2, 3.0, 0.0), 9);
  EXPECT_NEAR(fit.gamma.value, 2.2, 1e-6);
  EXPECT_NEAR(fit.first_count.value, 3.0, 1e-5);
  EXPECT_NEAR(fit.full_electrons_per_s[8], 1.24e7, 1e2);
  EXPECT_LT(fit.residual, 1e-6);
}

TEST(ResponseFit, SigmasCoverTheErrors) {
  for (const double first_count : {-2.0, 0.0, 3.0, 5.5}) {
    const ResponseFit fit = fit_response(squares_of(1.9, first_count, 0.01), 9);
    EXPECT_NEAR(fit.gamma.value, 1.9, 4.0 * fit.gamma.sigma);
    EXPECT_NEAR(fit.first_count.value, first_count, 4.0 * fit.first_count.sigma);
    EXPECT_LT(fit.gamma.sigma, 0.02);
    EXPECT_LT(fit.first_count.sigma, 0.1);
  }
}

TEST(ResponseFit, TooFewLevelsAreRefused) {
  auto squares = squares_of(2.2, 3.0, 0.0);
  squares.resize(3);
  EXPECT_THROW(static_cast<void>(fit_response(squares, 9)), std::runtime_error);
}

TEST(UniformityFit, IsTheSmoothPartOfTheField) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<PlaceLight> places;
  const auto field = [](const Vector2& px) {
    return 1.0 + 0.05 * px.x() / 1920.0 - 0.1 * std::pow((px.y() - 600.0) / 1200.0, 2);
  };
  for (double x = 50.0; x < 1920.0; x += 100.0)
    for (double y = 50.0; y < 1200.0; y += 100.0)
      places.push_back({{x, y}, 1e7 * field({x, y}) * (1.0 + 0.004 * normal(random))});
  const UniformityFit fit = fit_uniformity(places, 1920, 1200, 4);
  accuracy::Largest error;
  for (double x = 50.0; x < 1900.0; x += 37.0)
    for (double y = 50.0; y < 1180.0; y += 41.0)
      error.add(std::abs(fit.mean_electrons_per_s * fit.grid.at({x, y}) / (1e7 * field({x, y})) - 1.0));
  EXPECT_LT(error, 0.006);  // noise of 0.4 % over 228 places and 15 terms, bilinear between nodes
}

TEST(GainFit, IsMeanAndVarianceOfPoissonFrames) {
  // Photon transfer (Janesick 2007): variance = read variance + gain mean.
  std::mt19937 random(11);
  constexpr double kGain = 0.125, kRead = 7.0, kOffset = 64.0;
  const auto frame = [&](double electrons) {
    std::poisson_distribution<int> photons(electrons);
    std::normal_distribution<double> read(0.0, kRead);
    std::vector<std::uint16_t> dn(400 * 300);
    for (auto& value : dn)
      value = static_cast<std::uint16_t>(
          std::lround(kOffset + kGain * ((electrons > 0.0 ? photons(random) : 0) + read(random))));
    return dn;
  };
  const auto level = [&](double electrons) { return mean_variance({frame(electrons), frame(electrons)}, 400, 300); };
  std::vector<MeanVariance> grey;
  for (int k = 1; k <= 8; ++k) grey.push_back(level(2000.0 * k));
  const GainFit fit = fit_gain(level(0.0), grey);
  EXPECT_NEAR(fit.gain_dn_per_electron.value, kGain, 0.01 * kGain);
  EXPECT_NEAR(fit.gain_dn_per_electron.value, kGain, 4.0 * fit.gain_dn_per_electron.sigma);
  EXPECT_NEAR(fit.read_noise_electrons.value, kRead, 0.02 * kRead);
  EXPECT_THROW(static_cast<void>(fit_gain(level(0.0), {})), std::runtime_error);
}

TEST(DrawnDot, CentroidAndLightAreThoseOfItsCounts) {
  const Response response{2.2, 3.0};
  Picture counts = Picture(64, 48);
  const auto dot = draw_dot(counts, {30.3, 20.8}, 0.7, 0.05, response);
  ASSERT_TRUE(dot);
  double light = 0.0;
  Vector2 first = Vector2::Zero();
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const double luminance = counts.at(x, y) > 3 ? std::pow((counts.at(x, y) - 3.0) / 252.0, 2.2) : 0.0;
      light += luminance;
      first += luminance * Vector2(x, y);
    }
  EXPECT_NEAR(dot->full_pixels, light, 1e-12);
  EXPECT_LT((dot->centre_px - first / light).norm(), 1e-12);
  EXPECT_NEAR(light, 0.05, 0.002);
  EXPECT_LT((dot->centre_px - Vector2(30.3, 20.8)).norm(), 0.05);
  EXPECT_FALSE(draw_dot(counts, {1.0, 20.0}, 0.7, 0.05, response));
  EXPECT_FALSE(draw_dot(counts, {30.0, 46.9}, 0.7, 0.05, response));
}

}  // namespace
}  // namespace vbar::optical_stimulator::calibrate
