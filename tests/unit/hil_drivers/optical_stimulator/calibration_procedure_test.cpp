// The whole calibration against a bench in memory whose figures are known.

#include <cmath>
#include <cstdio>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hil_drivers/optical_stimulator/calibration/dots.h"
#include "hil_drivers/optical_stimulator/calibration/geometry_fit.h"
#include "hil_drivers/optical_stimulator/calibration/light_fit.h"
#include "hil_drivers/optical_stimulator/calibration/procedure.h"
#include "host_sim/twins/camera/optics.h"
#include "tests/support/fake_optical_bench.h"
#include "tests/support/figures.h"

namespace vbar::optical_stimulator::calibrate {

namespace {

ProcedureSettings small_settings() {
  ProcedureSettings settings;
  settings.camera = FakeOpticalBench::settings();
  settings.display_mm = 14.29;
  settings.focus_range_mm = 0.3;
  settings.geometry_grid = {14, 9};
  settings.held_out_grid = {10, 7};
  settings.uniformity_grid = {8, 5};
  return settings;
}

ProcedureResult calibrated(FakeOpticalBench& bench) {
  return calibrate({bench, bench, bench}, small_settings(),
                   [](const std::string& line) { std::printf("%s\n", line.c_str()); });
}

std::string failure_of(const FakeBenchTruth& truth) {
  FakeOpticalBench bench(truth);
  try {
    static_cast<void>(calibrated(bench));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "none";
}

TEST(Procedure, FindsTheFiguresOfTheBench) {
  const FakeBenchTruth truth;
  FakeOpticalBench bench(truth);
  const ProcedureResult result = calibrated(bench);
  const StimulatorCalibration& c = result.calibration;
  EXPECT_TRUE(bench.is_homed());
  EXPECT_NEAR(c.validity.rail_display_mm, truth.focus_mm,
              0.005);  // defocus of 5 um: 0.09 px of disc, no blur to be seen
  EXPECT_NEAR(c.camera.offset_dn.value, truth.offset_dn, 0.1);
  EXPECT_NEAR(c.camera.gain_dn_per_electron.value, truth.gain_dn_per_electron, 0.01 * truth.gain_dn_per_electron);
  EXPECT_NEAR(c.camera.read_noise_electrons.value, truth.read_noise_electrons, 0.03 * truth.read_noise_electrons);
  EXPECT_NEAR(c.camera.background_electrons_per_s.value, 125.0, 5.0);
  EXPECT_NEAR(c.light.contrast(), truth.contrast, 0.1 * truth.contrast);
  EXPECT_NEAR(c.light.gamma.value, truth.gamma, 0.02);             // required
  EXPECT_NEAR(c.light.first_count.value, truth.first_count, 0.5);  // required
  EXPECT_NEAR(c.light.full_pixel_electrons_per_s.value, truth.full_electrons_per_s, 0.02 * truth.full_electrons_per_s);
  EXPECT_EQ(c.camera.hot_pixels.size(), 6U);
  // A rendered point: 0.5 display pixels of 34.7 arcsec with the lens's 0.85 px.
  EXPECT_NEAR(c.camera.point_spread_sigma_px.value, std::hypot(0.85, 0.5), 0.03);
  EXPECT_TRUE(c.held_out.goal_reached);
  EXPECT_LE(c.held_out.detector.mean_arcsec, 1.0);
  EXPECT_GE(c.held_out.detector.dots, 50);
  EXPECT_GT(c.centroid_floor_px, 0.0);
  EXPECT_LT(c.centroid_floor_px, 0.05);
  EXPECT_EQ(toml_of(parse_calibration(toml_of(c), "calibration.toml")), toml_of(c));
  EXPECT_NE(calibration_page(result).find("reaches its goal"), std::string::npos);
}

TEST(Procedure, MapAndLightPredictDotsOfFourMagnitudes) {
  const FakeBenchTruth truth;
  FakeOpticalBench bench(truth);
  const StimulatorCalibration c = calibrated(bench).calibration;
  const Response response{c.light.gamma.value, c.light.first_count.value};
  for (const double full_pixels : {0.5, 0.08, 0.0125, 0.002}) {
    Picture counts = Picture(480, 300);
    const auto drawn = draw_dot(counts, {300.3, 140.6}, 0.5, full_pixels, response);
    ASSERT_TRUE(drawn);
    bench.show(counts);
    const double exposure_s = std::min(0.2, 0.004 / full_pixels);
    CameraPicture mean{480, 300, std::vector<float>(480 * 300, 0.0F)};
    for (int frame = 0; frame < 16; ++frame) {
      const auto dn = bench.take(exposure_s);
      for (std::size_t k = 0; k < dn.size(); ++k) mean.dn[k] += static_cast<float>(dn[k]) / 16.0F;
    }
    const auto seen = measure_dot(mean, {300.0, 150.0}, {.search_px = 40.0});
    ASSERT_TRUE(seen);
    const double expected = drawn->full_pixels * c.full_pixel_electrons_per_s(drawn->centre_px) * exposure_s;
    // Required: each within 0.05 mag. Pixels differ by 2 %, of which some four share the dot.
    EXPECT_NEAR(seen->light_dn / c.camera.gain_dn_per_electron.value / expected, 1.0, 0.047) << full_pixels;
  }
}

TEST(Procedure, MirroredDisplayIsRefused) {
  FakeBenchTruth truth;
  truth.is_mirrored = true;
  EXPECT_THAT(failure_of(truth), testing::HasSubstr("mirrored"));
}

TEST(Procedure, DisplayWithoutLightIsRefused) {
  FakeBenchTruth truth;
  truth.full_electrons_per_s = 1.0;
  EXPECT_NE(failure_of(truth).find("does not see the display"), std::string::npos);
}

TEST(Procedure, FocusBeyondItsRangeIsRefused) {
  FakeBenchTruth truth;
  truth.focus_mm = 14.72;
  EXPECT_NE(failure_of(truth).find("focus"), std::string::npos);
}

}  // namespace

}  // namespace vbar::optical_stimulator::calibrate

// The fitted map against an independent model of the bench's optics, on dots that were not used in the fit.

#ifdef VBAR_HAVE_OPENCV
#include <opencv2/calib3d.hpp>
#endif

namespace vbar::optical_stimulator::calibrate {

namespace {

using fsw::Vector2;
using fsw::Vector3;

const twins::camera::Region kRegion{710, 200, 500, 800};

/// A dot as the camera measures it; empty if beside the detector.
void add_dot(std::vector<Dot>& dots, BenchModel& bench, const Vector2& display_px, double noise_px) {
  static const twins::camera::Optics camera{twins::camera::CameraSettings{}};
  const Vector2 camera_px =
      camera.project(bench.direction_of(display_px)).value() + noise_px * Vector2(bench.normal(), bench.normal());
  if (camera_px.x() < 6 || camera_px.y() < 6 || camera_px.x() > 1913 || camera_px.y() > 1193) return;
  dots.push_back({display_px, camera_px, camera.direction_of(camera_px)});
}

std::vector<Dot> grid(BenchModel& bench, int columns, int rows, double noise_px) {
  std::vector<Dot> dots;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      add_dot(dots, bench, {8.0 + 1903.0 * column / (columns - 1), 8.0 + 1183.0 * row / (rows - 1)}, noise_px);
  return dots;
}

std::vector<Dot> random_dots(BenchModel& bench, int count, double noise_px) {
  std::vector<Dot> dots;
  for (int k = 0; k < count; ++k)
    add_dot(dots, bench, {8.0 + 1903.0 * bench.uniform(), 8.0 + 1183.0 * bench.uniform()}, noise_px);
  return dots;
}

/// On 32 x 20 dots of 0.01 px noise; held out 27 x 17 dots of the same noise, as in the table of the design brief.
HeldOutResiduals fitted_geometry(const BenchModelSettings& settings, GeometryFit* result = nullptr) {
  BenchModel bench(settings);
  const auto dots = grid(bench, 32, 20, 0.01), held_out = random_dots(bench, 459, 0.01);
  const GeometryFit fit = fit_geometry(dots, DisplayMapParameters{});
  if (result != nullptr) *result = fit;
  const HeldOutResiduals residuals = held_out_residuals(fit.map, held_out, kRegion);
  std::printf(
      "field %.0f arcsec, 1/%.0f: degree %d, region %.2f (95%% %.2f), detector %.2f (95%% %.2f), lens terms %.1f / "
      "%.1f arcsec\n",
      settings.field_rms_arcsec, 1.0 / settings.wave_number_sigma, fit.map.field.degree, residuals.region.mean_arcsec,
      residuals.region.p95_arcsec, residuals.detector.mean_arcsec, residuals.detector.p95_arcsec,
      residuals.region_lens_terms.mean_arcsec, residuals.detector_lens_terms.mean_arcsec);
  return residuals;
}

TEST(GeometryFit, SmoothFieldsAreFittedToTheNoiseOfTheDots) {
  for (const double field_arcsec : {6.0, 15.0, 18.0})
    for (const std::uint32_t seed : {1U, 2U}) {
      const HeldOutResiduals held_out = fitted_geometry({.field_rms_arcsec = field_arcsec, .seed = seed});
      // The noise of the held-out dots alone is 0.01 px of 34.5 arcsec: a mean angle of 0.43 arcsec.
      EXPECT_LE(held_out.region.mean_arcsec, 0.8);
      EXPECT_LE(held_out.detector.mean_arcsec, 0.8);
      EXPECT_LE(held_out.region.p95_arcsec, 1.6);
      EXPECT_LE(held_out.detector.p95_arcsec, 1.8);
      EXPECT_GE(held_out.detector_lens_terms.mean_arcsec, 0.4 * field_arcsec);
      EXPECT_TRUE(held_out.goal_reached);
    }
}

TEST(GeometryFit, RougherFieldStaysWithinItsLimitInTheRegion) {
  const HeldOutResiduals held_out = fitted_geometry({.field_rms_arcsec = 9.0, .wave_number_sigma = 1.0 / 180.0});
  EXPECT_LE(held_out.region.mean_arcsec, 2.5);  // required
}

TEST(GeometryFit, FieldThatTheDotsCannotResolveMissesTheGoal) {
  EXPECT_FALSE(fitted_geometry({.field_rms_arcsec = 6.0, .wave_number_sigma = 1.0 / 100.0}).goal_reached);
}

TEST(GeometryFit, WrongDotsHaveNoInfluence) {
  BenchModel bench({});
  auto dots = grid(bench, 32, 20, 0.01);
  const auto held_out = random_dots(bench, 200, 0.01);
  for (std::size_t k = 17; k < dots.size(); k += 91) dots[k].display_px += Vector2(9.0, -14.0);
  const GeometryFit fit = fit_geometry(dots, DisplayMapParameters{});
  EXPECT_LE(fit.dots_used, static_cast<int>(dots.size()) - 6);
  EXPECT_LE(held_out_residuals(fit.map, held_out, kRegion).detector.mean_arcsec, 0.8);
}

TEST(GeometryFit, TooFewDotsAreRefused) {
  BenchModel bench({});
  EXPECT_THROW(static_cast<void>(fit_geometry(grid(bench, 5, 5, 0.01), {})), std::runtime_error);
}

TEST(GeometryFit, LensTermsAreThoseThatMadeTheDots) {
  // Noise-free dots of the map's own lens terms.
  DisplayMapParameters truth;
  truth.lens.centre_px = {973.0, 590.0};
  truth.lens.scale_px = 5950.0;
  truth.lens.rotation_rad = 2.5e-3;
  truth.lens.tilt_rad = {4e-3, -6e-3};
  truth.lens.distortion = {0.9, -0.6, 1e-3, -7e-4, 1.5};
  const DisplayMap map(truth);
  std::vector<Dot> dots;
  for (double x = 10.0; x < 1920.0; x += 61.0)
    for (double y = 10.0; y < 1200.0; y += 61.0) dots.push_back({{x, y}, {x, y}, map.direction_of({x, y})});
  const LensTerms fitted = fit_lens(dots, LensTerms{}, LensFreedom::kAll, 3.0).lens;
  const auto expected = truth.lens.values(), values = fitted.values();
  for (std::size_t k = 0; k < values.size(); ++k)
    EXPECT_NEAR(values[k], expected[k], 1e-6 * std::max(1.0, std::abs(expected[k]))) << k;
}

TEST(GeometryFit, AgreesWithOpenCvsCalibration) {
#ifdef VBAR_HAVE_OPENCV
  // A noise-free grid, made by OpenCV; its calibration, from one view of the tangent plane as a plane at unit distance,
  // and the fit have to predict the same images. OpenCV takes points as floats: 1e-4 px.
  const cv::Mat truth = (cv::Mat_<double>(3, 3) << 5950.0, 0.0, 973.0, 0.0, 5950.0, 590.0, 0.0, 0.0, 1.0);
  std::vector<std::vector<cv::Point3f>> points(1);
  std::vector<std::vector<cv::Point2f>> images(1);
  for (double x = -0.16; x <= 0.16; x += 0.01)
    for (double y = -0.1; y <= 0.1; y += 0.01)
      points[0].emplace_back(static_cast<float>(x), static_cast<float>(y), 0.0F);
  cv::projectPoints(points[0], cv::Vec3d(0.0, 0.0, 2.5e-3), cv::Vec3d(0.0, 0.0, 1.0), truth,
                    std::vector<double>{0.9, -0.6, 1e-3, -7e-4, 1.5}, images[0]);
  cv::Mat camera = (cv::Mat_<double>(3, 3) << 6000.0, 0.0, 959.5, 0.0, 6000.0, 599.5, 0.0, 0.0, 1.0), distortion;
  std::vector<cv::Mat> rotations, translations;
  const double opencv_rms_px =
      cv::calibrateCamera(points, images, {1920, 1200}, camera, distortion, rotations, translations,
                          cv::CALIB_USE_INTRINSIC_GUESS | cv::CALIB_FIX_ASPECT_RATIO);
  std::vector<cv::Point2f> predicted;
  cv::projectPoints(points[0], rotations[0], translations[0], camera, distortion, predicted);

  std::vector<Dot> dots;
  for (std::size_t k = 0; k < points[0].size(); ++k)
    dots.push_back({{images[0][k].x, images[0][k].y}, {}, Vector3(points[0][k].x, points[0][k].y, 1.0).normalized()});
  const auto terms = fit_lens(dots, LensTerms{}, LensFreedom::kAll, 3.0).lens.values();
  accuracy::Largest difference_px;
  for (std::size_t k = 0; k < dots.size(); ++k) {
    const auto pixel =
        lens_pixel(terms.data(), static_cast<double>(points[0][k].x), static_cast<double>(points[0][k].y));
    difference_px.add(std::hypot(pixel[0] - predicted[k].x, pixel[1] - predicted[k].y));
  }
  EXPECT_LE(opencv_rms_px, 1e-3);
  EXPECT_LE(difference_px, 5e-3);
#else
  GTEST_SKIP() << "OpenCV is not installed";
#endif
}

TEST(ResidualFigures, AreMeanAndQuantileOfTheAngle) {
  std::vector<Residual> residuals;
  for (int k = 1; k <= 100; ++k) residuals.push_back({{0.0, 0.0}, {0.6 * k, -0.8 * k}});
  const ResidualFigures figures = figures_of(residuals);
  EXPECT_NEAR(figures.mean_arcsec, 50.5, 1e-9);
  EXPECT_NEAR(figures.p95_arcsec, 95.0, 1e-9);
  EXPECT_EQ(figures.dots, 100);
  EXPECT_EQ(figures_of({}).dots, 0);
  EXPECT_TRUE(in_region(residuals, kRegion).empty());
}

}  // namespace

// Fits of light and noise on synthetic measurements, and what dots are in linear light.

namespace {

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
