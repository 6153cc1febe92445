// The calibration and its file.

#include "hil_drivers/optical_stimulator/calibration_file/bench_calibration.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "host_sim/mission/mission_error.h"
#include "tests/support/bench_calibration_example.h"

namespace vbar::optical_stimulator {
namespace {

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

TEST(BenchCalibration, FileReadsBackWithTheSameBits) {
  const BenchCalibration written = bench_calibration_example();
  const std::string text = toml_of(written);
  const BenchCalibration read = parse_calibration(text, "bench.toml");
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

TEST(BenchCalibration, IsSavedAsAWhole) {
  const auto file = std::filesystem::path(testing::TempDir()) / "bench_calibration_test.toml";
  save_calibration(bench_calibration_example(), file);
  EXPECT_EQ(toml_of(load_calibration(file)), toml_of(bench_calibration_example()));
  EXPECT_FALSE(std::filesystem::exists(file.string() + ".partial"));
  std::filesystem::remove(file);
  EXPECT_THROW(save_calibration(bench_calibration_example(), "/nowhere/at/all.toml"), std::runtime_error);
}

TEST(BenchCalibration, DamagedFilesAreRefusedWithTheirKey) {
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

TEST(BenchCalibration, EveryTruncationIsRefused) {
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
