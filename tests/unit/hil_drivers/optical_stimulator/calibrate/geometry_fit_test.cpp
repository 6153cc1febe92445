// The fitted map against an independent model of the bench's optics, on dots that were not used in the fit.

#include "hil_drivers/optical_stimulator/calibrate/geometry_fit.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "hil_drivers/optical_stimulator/calibrate/goals.h"
#include "host_sim/twins/camera/optics.h"
#include "tests/support/figures.h"
#include "tests/support/optical_bench_model.h"

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
}  // namespace vbar::optical_stimulator::calibrate
