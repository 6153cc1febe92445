// Calibration of the emulated bench at its full size, without its wires: figures against those of its bench file.

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "emulators/optical_stimulator/optical_path.h"
#include "hil_drivers/optical_stimulator/calibration/procedure.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/sensors/settings/camera_file.h"
#include "tests/support/figures.h"

namespace vbar::optical_stimulator::calibrate {
namespace {

using fsw::Vector2;

std::filesystem::path data() {
  return mission::data_directory();
}

bench::BenchSettings bench_of(int seed, std::vector<std::string> assignments) {
  assignments.push_back("seed=" + std::to_string(seed));
  return bench::read_bench(data() / "benches" / "optical_stimulator.toml", assignments);
}

class PathBench final : public Screen, public Eye, public Rails {
 public:
  explicit PathBench(const bench::BenchSettings& settings)
      : settings_(settings),
        path_(settings, bench::camera_of(settings, data())),
        shown_(std::make_shared<std::vector<std::uint8_t>>(1920 * 1200)) {}

  [[nodiscard]] int width() const override { return 1920; }
  [[nodiscard]] int height() const override { return 1200; }
  [[nodiscard]] int bits() const override { return 12; }
  void show(const Picture& counts) override { shown_ = std::make_shared<std::vector<std::uint8_t>>(counts.counts); }
  void home() override {}
  // The zeros of the axes are 15 and 20 mm, here with an error of 0.07 and -0.05 mm.
  void move_to(double lens_mm, double display_mm) override { places_ = {15.07 + lens_mm, 19.95 + display_mm}; }
  std::vector<std::uint16_t> take(double exposure_s) override {
    const bench::Pictures pictures{{shown_, 1.0}};
    std::vector<std::uint16_t> dn;
    path_.expose(pictures, {{0, 0, 1920, 1200}, {exposure_s, 0.0, 64.0}}, places_, {}, frames_++, dn);
    return dn;
  }

  [[nodiscard]] const bench::BenchSettings& settings() const { return settings_; }
  [[nodiscard]] std::uint64_t frames() const { return frames_; }

 private:
  bench::BenchSettings settings_;
  bench::OpticalPath path_;
  std::shared_ptr<const std::vector<std::uint8_t>> shown_;
  bench::RailPlaces places_;
  std::uint64_t frames_ = 0;
};

StimulatorCalibration calibrated(PathBench& bench) {
  ProcedureSettings settings;
  settings.camera = sensors::load_camera(data() / "cameras" / "optical_stimulator.toml").settings();
  const auto begin = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
  const ProcedureResult result = calibrate({bench, bench, bench}, settings, [&](const std::string& line) {
    std::printf("%6.1f s  %s\n", elapsed(), line.c_str());
  });
  std::printf("%6.1f s  %d frames\n", elapsed(), static_cast<int>(bench.frames()));
  return result.calibration;
}

/// Of 7 x 7 pixels.
double narrow_light_dn(const CameraPicture& picture, const DotMeasurement& dot) {
  const int x = static_cast<int>(std::lround(dot.centre_px.x())), y = static_cast<int>(std::lround(dot.centre_px.y()));
  double light = 0.0;
  for (int dy = -3; dy <= 3; ++dy)
    for (int dx = -3; dx <= 3; ++dx) light += picture.at(x + dx, y + dy) - dot.background_dn;
  return light;
}

/// Light of dots of magnitudes -0.5 to 7.5 over what the calibration predicts, 16 frames each. A faint dot is measured
/// in a narrow window, whose noise is small, with the share of the light beside it from the bright dots.
std::vector<double> light_ratios(PathBench& bench, const StimulatorCalibration& c) {
  const Response response{c.light.gamma.value, c.light.first_count.value};
  std::vector<double> ratios;
  double wide_over_narrow = 0.0;
  int bright_dots = 0;
  constexpr double kFullPixelMagnitude = -0.86;  // of a full pixel of 200 cd/m2, design brief
  std::vector<DrawnDot> drawn;
  for (double magnitude = -0.5; magnitude <= 7.5; magnitude += 0.5) {
    Picture counts = Picture(1920, 1200);
    const double full_pixels = std::pow(10.0, -0.4 * (magnitude - kFullPixelMagnitude));
    const auto dot = draw_dot(counts, {800.0 + 20.3 * magnitude, 500.0 + 33.7 * magnitude}, 0.5, full_pixels, response);
    bench.show(counts);
    const double exposure_s = std::min(0.2, 0.006 / full_pixels);  // below saturation
    CameraPicture mean{1920, 1200, std::vector<float>(1920 * 1200, 0.0F)};
    for (int frame = 0; frame < 16; ++frame) {
      const auto dn = bench.take(exposure_s);
      for (std::size_t k = 0; k < dn.size(); ++k) mean.dn[k] += static_cast<float>(dn[k]) / 16.0F;
    }
    const DisplayMap map(c.geometry);
    const twins::camera::Optics camera(sensors::load_camera(data() / "cameras" / "optical_stimulator.toml").settings());
    const Vector2 expected = camera.project(map.direction_of(dot->centre_px)).value();
    const auto seen = measure_dot(mean, expected, {.search_px = 3.0, .half_width_px = 12, .peak_min_dn = 3.0});
    if (!seen) return {std::nan("")};
    const double narrow_dn = narrow_light_dn(mean, *seen);
    const double electrons = dot->full_pixels * c.full_pixel_electrons_per_s(dot->centre_px) * exposure_s;
    const bool is_bright = electrons > 40'000.0;
    if (is_bright) {
      wide_over_narrow = (wide_over_narrow * bright_dots + seen->light_dn / narrow_dn) / (bright_dots + 1);
      ++bright_dots;
    }
    const double light_dn = is_bright ? seen->light_dn : narrow_dn * wide_over_narrow;
    ratios.push_back(light_dn / c.camera.gain_dn_per_electron.value / electrons);
    std::printf("magnitude %4.1f: %9.0f electrons, measured %.4f of it\n", magnitude, electrons, ratios.back());
  }
  return ratios;
}

TEST(CalibratedBench, ReachesTheGoalsOfGeometryAndLight) {
  PathBench bench(bench_of(1, {}));
  const StimulatorCalibration c = calibrated(bench);
  EXPECT_TRUE(c.held_out.goal_reached);
  EXPECT_NEAR(c.light.gamma.value, bench.settings().light.gamma, 0.02);
  EXPECT_NEAR(c.light.first_count.value, bench.settings().light.first_count, 0.5);
  accuracy::Largest worst;
  double mean = 0.0;
  const std::vector<double> ratios = light_ratios(bench, c);
  for (const double ratio : ratios) {
    worst.add(std::abs(2.5 * std::log10(ratio)));
    mean += std::abs(ratio - 1.0) / static_cast<double>(ratios.size());
  }
  EXPECT_LE(mean, 0.02);
  EXPECT_LE(worst, 0.05);
}

TEST(CalibratedBench, RougherFieldStaysWithinItsLimitInTheRegion) {
  PathBench bench(bench_of(1, {"field.direction_arcsec=9.0", "field.wave_length_px=180.0"}));
  EXPECT_LE(calibrated(bench).held_out.region.mean_arcsec, 2.5);
}

TEST(CalibratedBench, FieldTooRoughIsReported) {
  PathBench bench(bench_of(1, {"field.direction_arcsec=9.0", "field.wave_length_px=100.0"}));
  EXPECT_FALSE(calibrated(bench).held_out.goal_reached);
}

}  // namespace
}  // namespace vbar::optical_stimulator::calibrate
