// The whole calibration against a bench in memory whose figures are known.

#include "hil_drivers/optical_stimulator/calibrate/procedure.h"

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "hil_drivers/optical_stimulator/calibrate/calibration_page.h"
#include "tests/support/fake_optical_bench.h"

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
  const BenchCalibration& c = result.calibration;
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
  const BenchCalibration c = calibrated(bench).calibration;
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
