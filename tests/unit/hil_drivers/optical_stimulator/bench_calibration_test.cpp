// The calibration and its file.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hil_drivers/optical_stimulator/optics/calibration.h"
#include "hil_drivers/optical_stimulator/optics/display_map.h"
#include "host_sim/mission/mission_error.h"
#include "tests/support/figures.h"

namespace vbar::optical_stimulator {
namespace {

// A calibration in which every figure has a value of its own.

// A display map with every term: lens terms of the size of a bench's, and a field of degree 16.

DisplayMapParameters display_map_example() {
  DisplayMapParameters parameters;
  parameters.lens.centre_px = {973.1, 590.2};
  parameters.lens.scale_px = 5952.4;
  parameters.lens.rotation_rad = 2.5e-3;
  parameters.lens.tilt_rad = {4e-3, -6e-3};
  parameters.lens.distortion = {0.9, -0.6, -1e-3, 7e-4, 2.0};
  ChebyshevField& field = parameters.field;
  field.degree = ChebyshevField::kDegreeMax;
  field.low_px = {6.0, 4.0};
  field.high_px = {1911.0, 1193.0};
  for (std::size_t k = 0; k < ChebyshevField::term_count(field.degree); ++k) {
    field.x_px.push_back(0.1 * std::sin(3.0 * static_cast<double>(k) + 1.0));
    field.y_px.push_back(0.1 * std::cos(5.0 * static_cast<double>(k)));
  }
  return parameters;
}

StimulatorCalibration bench_calibration_example() {
  StimulatorCalibration c;
  c.validity = {"2026-11-22T23:00:00Z",
                true,
                "Point Grey Research",
                "Grasshopper3 GS3-PGE-23S6M",
                "14\"1\\7",
                40.0,
                34.2857142857142847,
                1920,
                1200,
                60.0,
                {710, 200, 500, 800},
                0.2};
  c.geometry = display_map_example();
  c.lens_sigma.centre_px = {0.01, 0.02};
  c.lens_sigma.scale_px = 0.1 + 0.2;
  c.lens_sigma.distortion = {1e-3, 1e-2, 1e-5, 1.0 / 3.0, 0.7};
  c.field_sigma_px = 0.004;
  c.light = {{1.2e7, 3e4}, {1.2e2, 0.4}, {2.2, 0.002}, {3.0, 0.05}, 0.011};
  c.uniformity = {3, 2, {100.5, 200.25}, {800.0, 700.0}, {0.9, 1.0, 1.1, 1.05, 0.97, 0.98}, 0.004};
  c.camera = {
      {66.0, 0.01}, {0.12875, 1e-5}, {7.7, 0.02}, {125.0, 0.5}, {0.99, 0.003}, 12, {{5, 7, 1e4}, {1919, 1199, 2.5e4}}};
  c.held_out = {{0.5, 1.1, 120}, {0.6, 1.4, 459}, {9.8, 20.1, 120}, {11.7, 24.4, 459}, true};
  c.centroid_floor_px = 0.021;
  return c;
}

std::string refusal_of(const std::string& text) {
  try {
    static_cast<void>(parse_calibration(text, "bench.toml"));
  } catch (const mission::MissionError& error) {
    return error.what();
  }
  return "accepted";
}

std::string with(const std::string& from, const std::string& to) {
  std::string text = toml_of(bench_calibration_example());
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(StimulatorCalibration, FileReadsBackWithTheSameBits) {
  const StimulatorCalibration written = bench_calibration_example();
  const std::string text = toml_of(written);
  const StimulatorCalibration read = parse_calibration(text, "bench.toml");
  EXPECT_EQ(toml_of(read), text);  // every figure of the example differs from its default
  EXPECT_EQ(read.geometry.lens.values(), written.geometry.lens.values());
  EXPECT_EQ(read.geometry.field.y_px, written.geometry.field.y_px);
  EXPECT_EQ(read.validity.camera_serial, written.validity.camera_serial);
  EXPECT_EQ(read.validity.region, written.validity.region);
  EXPECT_EQ(read.light.gamma.sigma, written.light.gamma.sigma);
  EXPECT_EQ(read.camera.hot_pixels.size(), 2U);
  EXPECT_EQ(read.camera.hot_pixels.back().electrons_per_s, 2.5e4);
  EXPECT_EQ(read.lens_sigma.scale_px, 0.1 + 0.2);
  EXPECT_EQ(read.held_out.detector_lens_terms.p95_arcsec, 24.4);
}

TEST(StimulatorCalibration, IsSavedAsAWhole) {
  const auto file = std::filesystem::path(testing::TempDir()) / "bench_calibration_test.toml";
  save_calibration(bench_calibration_example(), file);
  EXPECT_EQ(toml_of(load_calibration(file)), toml_of(bench_calibration_example()));
  EXPECT_FALSE(std::filesystem::exists(file.string() + ".partial"));
  std::filesystem::remove(file);
  EXPECT_THROW(save_calibration(bench_calibration_example(), "/nowhere/at/all.toml"), std::runtime_error);
}

TEST(StimulatorCalibration, DamagedFilesAreRefusedWithTheirKey) {
  EXPECT_NE(refusal_of(with("gamma = 2.2", "gamma = nan")).find("light.gamma"), std::string::npos);
  EXPECT_NE(refusal_of(with("gamma_sigma = 0.002", "")).find("light.gamma_sigma"), std::string::npos);
  EXPECT_NE(refusal_of(with("degree = 16", "degree = 17")).find("geometry.field.degree"), std::string::npos);
  EXPECT_NE(refusal_of(with("degree = 16", "degree = 12")).find("geometry.field.x_px"), std::string::npos);
  EXPECT_NE(refusal_of(with("columns = 3", "columns = 4")).find("uniformity.values"), std::string::npos);
  EXPECT_NE(refusal_of(with("emulated = true\n", "")).find("validity.emulated"), std::string::npos);
  EXPECT_NE(refusal_of(with("scale_px = 5952.4", "scale_px = 0")).find("geometry.lens.scale_px"), std::string::npos);
  EXPECT_NE(refusal_of(with("distortion = [0.9, ", "distortion = [-40, ")).find("geometry.lens"), std::string::npos);
  EXPECT_NE(refusal_of(with("[camera]", "[camera]\nlens = 3")).find("camera.lens"), std::string::npos);
  EXPECT_NE(refusal_of(with("display_px = [1920, 1200]", "display_px = [1920.5, 1200]")).find("validity.display_px"),
            std::string::npos);
  EXPECT_NE(refusal_of("").find("bench.toml"), std::string::npos);
  EXPECT_NE(refusal_of("gamma = [").find("bench.toml"), std::string::npos);
}

TEST(StimulatorCalibration, EveryTruncationIsRefused) {
  const std::string text = toml_of(bench_calibration_example());
  const auto last_table = text.find("[held_out.detector_lens_terms]");
  for (std::size_t length = 0; length < last_table + 40; length += 37)
    EXPECT_NE(refusal_of(text.substr(0, length)).find("bench.toml"), std::string::npos) << length;
}

TEST(UniformityGrid, IsBilinearBetweenNodesAndConstantBeyond) {
  const UniformityGrid grid = bench_calibration_example().uniformity;
  EXPECT_DOUBLE_EQ(grid.at({100.5, 200.25}), 0.9);
  EXPECT_DOUBLE_EQ(grid.at({1700.5, 900.25}), 0.98);
  EXPECT_DOUBLE_EQ(grid.at({500.5, 550.25}), 0.25 * (0.9 + 1.0 + 1.05 + 0.97));
  EXPECT_DOUBLE_EQ(grid.at({-1e9, -1e9}), 0.9);
  EXPECT_DOUBLE_EQ(grid.at({1e9, 1e9}), 0.98);
  EXPECT_DOUBLE_EQ(UniformityGrid{}.at({3.0, 4.0}), 1.0);
  EXPECT_DOUBLE_EQ((UniformityGrid{1, 1, {0.0, 0.0}, {1.0, 1.0}, {0.7}, 0.0}.at({3.0, 4.0})), 0.7);
}

TEST(CountsToLight, FollowsTheDisplaysLaw) {
  const CountsToLight light = bench_calibration_example().light;
  EXPECT_DOUBLE_EQ(light.electrons_per_s(255.0), 1.2e7);
  EXPECT_EQ(light.electrons_per_s(3.0), 0.0);
  EXPECT_DOUBLE_EQ(light.electrons_per_s(129.0), 1.2e7 * std::pow(0.5, 2.2));
  EXPECT_DOUBLE_EQ(light.contrast(), 1e5);
}

}  // namespace

}  // namespace vbar::optical_stimulator

// The map of directions onto display pixels: against OpenCV's projection, its own inverse, and differences.

#ifdef VBAR_HAVE_OPENCV
#include <opencv2/calib3d.hpp>
#endif

namespace vbar::optical_stimulator {

namespace {

using accuracy::Largest;
using fsw::Vector2;
using fsw::Vector3;

Vector3 direction_at(double x, double y) {
  return Vector3(x, y, 1.0).normalized();
}

TEST(DisplayMap, LensTermsAreOpenCvsTiltedProjection) {
#ifdef VBAR_HAVE_OPENCV
  DisplayMapParameters parameters = display_map_example();
  parameters.field = {};
  const LensTerms& lens = parameters.lens;
  const DisplayMap map(parameters);
  std::vector<cv::Point3d> points;
  for (double x = -0.165; x <= 0.165; x += 0.005)
    for (double y = -0.105; y <= 0.105; y += 0.005) points.emplace_back(x, y, 1.0);
  const cv::Mat camera = (cv::Mat_<double>(3, 3) << lens.scale_px, 0.0, lens.centre_px[0], 0.0, lens.scale_px,
                          lens.centre_px[1], 0.0, 0.0, 1.0);
  const auto& k = lens.distortion;
  const std::vector<double> distortion{
      k[0], k[1], k[2], k[3], k[4], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, lens.tilt_rad[0], lens.tilt_rad[1]};
  std::vector<cv::Point2d> expected;
  cv::projectPoints(points, cv::Vec3d(0.0, 0.0, lens.rotation_rad), cv::Vec3d(0.0, 0.0, 0.0), camera, distortion,
                    expected);
  Largest error_px;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const auto pixel = map.project(Vector3(points[n].x, points[n].y, points[n].z));
    ASSERT_TRUE(pixel);
    error_px.add((*pixel - Vector2(expected[n].x, expected[n].y)).norm());
  }
  EXPECT_LT(error_px, 1e-6);  // required; rounding is 1e-12
#else
  GTEST_SKIP() << "OpenCV is not installed";
#endif
}

TEST(DisplayMap, InverseHoldsOverTheDisplay) {
  DayCorrection correction;
  correction.shift_px = {0.3, -0.8};
  correction.rotation_rad = 1e-4;
  correction.scale = 1.0 + 5e-5;
  for (const DisplayMap& map : {DisplayMap(display_map_example()), DisplayMap(display_map_example(), correction)}) {
    Largest error_px;
    for (int x = 0; x < 1920; x += 7)
      for (int y = 0; y < 1200; y += 11) {
        const Vector2 pixel(x == 1918 ? 1919 : x, y == 1199 ? 1199 : y);
        const Vector3 direction = map.direction_of(pixel);
        EXPECT_NEAR(direction.norm(), 1.0, 1e-14);
        error_px.add((map.project(direction).value() - pixel).norm());
      }
    EXPECT_LT(error_px, 1e-6);  // required
  }
}

TEST(DisplayMap, ImageVelocityIsTheDerivativeOfTheProjection) {
  const DisplayMap map(display_map_example());
  const Vector3 rate(2e-3, -1e-3, 5e-4);
  constexpr double kStep_s = 1e-3;
  Largest error;
  for (double x = -0.3; x <= 0.3; x += 0.0173)  // beyond the display too, where the distortion continues in proportion
    for (double y = -0.2; y <= 0.2; y += 0.0131) {
      const Vector3 direction = direction_at(x, y);
      const Vector2 difference =
          map.project(direction + kStep_s * rate).value() - map.project(direction - kStep_s * rate).value();
      const Vector2 velocity = map.image_velocity(direction, rate);
      error.add((difference / (2.0 * kStep_s) - velocity).norm() / velocity.norm());
    }
  EXPECT_LT(error, 2e-4);  // steps of 0.01 px; two directions of the grid lie within a step of the domain's edge
}

TEST(DisplayMap, DirectionsBesideTheDisplayStayBesideIt) {
  const DisplayMap map(display_map_example());
  EXPECT_FALSE(map.project(Vector3(1.0, 0.0, 0.3)));
  EXPECT_FALSE(map.project(Vector3(0.0, 0.0, -1.0)));
  EXPECT_FALSE(map.project(Vector3(std::nan(""), 0.0, 1.0)));
  for (double angle = 0.0; angle < 6.28; angle += 0.1) {
    double last_px = 0.0;
    for (double radius = 0.05; radius < 2.7; radius *= 1.05) {
      const auto pixel = map.project(direction_at(radius * std::cos(angle), radius * std::sin(angle)));
      ASSERT_TRUE(pixel);
      const double from_centre_px = (*pixel - Vector2(973.1, 590.2)).norm();
      EXPECT_GT(from_centre_px, last_px);
      last_px = from_centre_px;
    }
  }
}

TEST(DisplayMap, DaysCorrectionMovesTheDisplayAboutItsMiddle) {
  DayCorrection correction;
  correction.shift_px = {1.5, -2.0};
  correction.rotation_rad = 1e-3;
  correction.scale = 1.001;
  const DisplayMap before(display_map_example()), after(display_map_example(), correction);
  const Vector2 middle(959.5, 599.5);
  const Vector3 on_axis = before.direction_of(middle), right = before.direction_of(middle + Vector2(500.0, 0.0));
  EXPECT_LT((after.project(on_axis).value() - (middle + Vector2(1.5, -2.0))).norm(), 1e-8);
  const Vector2 moved = middle + Vector2(1.5 + 500.5 * std::cos(1e-3), -2.0 + 500.5 * std::sin(1e-3));
  EXPECT_LT((after.project(right).value() - moved).norm(), 1e-8);
}

TEST(DisplayMap, IsThePinholeWithoutTerms) {
  const DisplayMap map(DisplayMapParameters{});
  EXPECT_LT((map.project(Vector3(0.1, -0.05, 1.0)).value() - Vector2(959.5 + 600.0, 599.5 - 300.0)).norm(), 1e-9);
  EXPECT_NEAR(map.focal_length_px(), 6000.0, 1e-9);
  EXPECT_EQ(map.vignetting({0.0, 0.0}), 1.0);
}

TEST(ChebyshevField, IsConstantBeyondItsDomain) {
  const ChebyshevField field = display_map_example().field;
  const FieldValue edge = value_of(field, {1911.0, 600.0}), beyond = value_of(field, {5000.0, 600.0});
  EXPECT_EQ(edge.offset_px, beyond.offset_px);
  EXPECT_EQ(beyond.jacobian.col(0).norm(), 0.0);
}

TEST(ChebyshevField, HasTheSeriesOfClenshawsCosines) {
  // T_n(cos t) = cos n t: the field at u = cos a, v = cos b.
  const ChebyshevField field = display_map_example().field;
  const double a = 0.7, b = 2.1;
  const Vector2 half = 0.5 * (field.high_px - field.low_px), middle = 0.5 * (field.high_px + field.low_px);
  const Vector2 pixel = middle + Vector2(half.x() * std::cos(a), half.y() * std::cos(b));
  Vector2 expected = Vector2::Zero();
  std::size_t term = 0;
  for (int sum = 0; sum <= field.degree; ++sum)
    for (int j = 0; j <= sum; ++j, ++term)
      expected += Vector2(field.x_px[term], field.y_px[term]) * std::cos((sum - j) * a) * std::cos(j * b);
  EXPECT_LT((value_of(field, pixel).offset_px - expected).norm(), 1e-12);
}

}  // namespace

}  // namespace vbar::optical_stimulator
