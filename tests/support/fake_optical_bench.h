#pragma once
// A small bench in memory, behind the interfaces of the calibration: a display of 480 x 300 pixels whose every lit
// pixel is drawn as a Gaussian where an independent model of the optics places it, on a camera of as many pixels.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "hil_drivers/optical_stimulator/calibration/procedure.h"
#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/optics.h"

namespace vbar::optical_stimulator {

// The optics of a bench, from the display to the directions: independent of the display map, whose inverse it is. It
// has lens terms on the display's side and a smooth field that no lens model represents (a sum of plane waves).

struct BenchModelSettings {
  double field_rms_arcsec = 15.0;          ///< an axis
  double wave_number_sigma = 1.0 / 300.0;  ///< rad per display pixel
  bool has_lens_errors = true;
  std::uint32_t seed = 1;
  double width_px = 1920.0, height_px = 1200.0;
};

class BenchModel {
 public:
  explicit BenchModel(const BenchModelSettings& settings) : settings_(settings), random_(settings.seed) {
    for (int k = 0; k < kWaves; ++k)
      waves_.push_back(
          {settings.wave_number_sigma * normal(), settings.wave_number_sigma * normal(), angle(), angle(), angle()});
  }

  /// Seen from the camera, unit. The display is 34.7 arcsec a pixel; k1 = -0.9, k2 = 3, tilted by 4 and -6 mrad.
  [[nodiscard]] fsw::Vector3 direction_of(const fsw::Vector2& display_px) const {
    constexpr double kPixel = 9.6e-3 / 57.142857;
    const fsw::Vector2 middle(0.5 * (settings_.width_px - 1.0), 0.5 * (settings_.height_px - 1.0));
    fsw::Vector2 plane = kPixel * (display_px - middle);
    if (settings_.has_lens_errors) plane = distorted(tilted(plane + fsw::Vector2(0.13, -0.09) / 57.142857));
    return fsw::Vector3(plane.x() + wave_sum(display_px, &Wave::phase_x),
                        plane.y() + wave_sum(display_px, &Wave::phase_y), 1.0)
        .normalized();
  }

  double normal() { return normal_(random_); }
  double uniform() { return uniform_(random_); }

 private:
  static constexpr int kWaves = 60;
  struct Wave {
    double kx, ky, phase_x, phase_y, unused;
  };
  double angle() { return 2.0 * std::numbers::pi * uniform_(random_); }

  [[nodiscard]] double wave_sum(const fsw::Vector2& px, double Wave::*phase) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) sum += std::cos(wave.kx * px.x() + wave.ky * px.y() + wave.*phase);
    return sum * settings_.field_rms_arcsec / 206264.8 * std::sqrt(2.0 / kWaves);
  }
  static fsw::Vector2 tilted(const fsw::Vector2& plane) {
    const fsw::Matrix3 rotation =
        (Eigen::AngleAxisd(4e-3, fsw::Vector3::UnitX()) * Eigen::AngleAxisd(-6e-3, fsw::Vector3::UnitY()) *
         Eigen::AngleAxisd(2.5e-3, fsw::Vector3::UnitZ()))
            .toRotationMatrix();
    const fsw::Vector3 point = rotation * fsw::Vector3(plane.x(), plane.y(), 0.0) + fsw::Vector3::UnitZ();
    return point.head<2>() / point.z();
  }
  static fsw::Vector2 distorted(const fsw::Vector2& plane) {
    constexpr double k1 = -0.9, k2 = 3.0, p1 = 1e-3, p2 = -7e-4;
    const double x = plane.x(), y = plane.y(), r2 = plane.squaredNorm(), radial = 1.0 + r2 * (k1 + r2 * k2);
    return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
  }

  BenchModelSettings settings_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
  std::vector<Wave> waves_;
};

struct FakeBenchTruth {
  double gamma = 2.2, first_count = 3.0, full_electrons_per_s = 1.2e7, contrast = 1e5, pixel_unevenness = 0.02;
  double offset_dn = 66.0, gain_dn_per_electron = 0.12875, read_noise_electrons = 7.7, dark_electrons_per_s = 5.0;
  double point_spread_px = 0.85, focus_mm = 14.4;
  int hot_pixels = 6;
  bool is_mirrored = false;
  BenchModelSettings optics{.width_px = 480.0, .height_px = 300.0};
};

class FakeOpticalBench final : public calibrate::Screen, public calibrate::Eye, public calibrate::Rails {
 public:
  explicit FakeOpticalBench(const FakeBenchTruth& truth)
      : truth_(truth), model_(truth.optics), camera_(settings()), counts_(Picture(480, 300)) {
    for (std::size_t k = 0; k < kPixels; ++k) {
      const auto x = static_cast<double>(k % 480), y = static_cast<double>(k / 480);
      places_.push_back(camera_.project(model_.direction_of({truth.is_mirrored ? 479.0 - x : x, y})).value());
      evenness_.push_back(std::max(0.5, 1.0 + truth.pixel_unevenness * normal_(random_)));
    }
    for (int k = 0; k < truth.hot_pixels; ++k) hot_.push_back(static_cast<std::size_t>(random_() % kPixels));
  }

  static twins::camera::CameraSettings settings() {
    twins::camera::CameraSettings camera;
    camera.detector.width = 480;
    camera.detector.height = 300;
    camera.optics.principal_point_px = {239.5, 149.5};
    camera.region = {140, 50, 200, 200};
    return camera;
  }

  [[nodiscard]] int width() const override { return 480; }
  [[nodiscard]] int height() const override { return 300; }
  [[nodiscard]] int bits() const override { return 12; }
  void show(const Picture& counts) override { counts_ = counts; }
  void home() override { is_homed_ = true; }
  void move_to(double, double display_mm) override { display_mm_ = display_mm; }

  std::vector<std::uint16_t> take(double exposure_s) override {
    const std::vector<double> electrons = light(exposure_s);
    std::vector<std::uint16_t> dn(kPixels);
    for (std::size_t k = 0; k < kPixels; ++k) {
      const double charge = std::min(32000.0, electrons[k] + std::sqrt(electrons[k]) * normal_(random_));
      const double read = charge + truth_.read_noise_electrons * normal_(random_);
      dn[k] = static_cast<std::uint16_t>(
          std::clamp(std::round(truth_.offset_dn + truth_.gain_dn_per_electron * read), 0.0, 4095.0));
    }
    return dn;
  }

  [[nodiscard]] bool is_homed() const { return is_homed_; }
  [[nodiscard]] double display_mm() const { return display_mm_; }
  [[nodiscard]] BenchModel& model() { return model_; }

 private:
  static constexpr std::size_t kPixels = 480 * 300;

  [[nodiscard]] std::vector<double> light(double exposure_s) const {
    const double full = truth_.full_electrons_per_s * exposure_s;
    std::vector<double> electrons(kPixels, full / truth_.contrast + truth_.dark_electrons_per_s * exposure_s);
    for (const std::size_t k : hot_) electrons[k] += 20000.0 * exposure_s;
    const bool is_even = std::all_of(counts_.counts.begin(), counts_.counts.end(),
                                     [&](auto count) { return count == counts_.counts[0]; });
    for (std::size_t k = 0; k < kPixels; ++k) {
      const double signal = counts_.counts[k] - truth_.first_count;
      if (!(signal > 0.0)) continue;
      const double lit = full * evenness_[k] * std::pow(signal / (255.0 - truth_.first_count), truth_.gamma);
      if (is_even)
        electrons[k] += lit;
      else
        splat(electrons, places_[k], lit);
    }
    return electrons;
  }

  void splat(std::vector<double>& electrons, const fsw::Vector2& at, double light) const {
    const double blur_px =
        33.4 * (display_mm_ - truth_.focus_mm) / 4.0;  // 18.4 mm of aperture over 57.1 mm squared, disc to sigma
    const double sigma = std::hypot(truth_.point_spread_px, blur_px), scale = std::sqrt(0.5) / sigma;
    const int reach = static_cast<int>(std::ceil(5.0 * sigma));
    const int cx = static_cast<int>(std::lround(at.x())), cy = static_cast<int>(std::lround(at.y()));
    std::vector<double> columns;
    for (int x = cx - reach; x <= cx + reach; ++x) columns.push_back(share(x - at.x(), scale));
    for (int y = std::max(0, cy - reach); y <= std::min(299, cy + reach); ++y) {
      const double row = light * share(y - at.y(), scale);
      for (int x = std::max(0, cx - reach); x <= std::min(479, cx + reach); ++x)
        electrons[static_cast<std::size_t>(y) * 480 + static_cast<std::size_t>(x)] +=
            row * columns[static_cast<std::size_t>(x - cx + reach)];
    }
  }
  static double share(double from_centre, double scale) {
    return 0.5 * (std::erf((from_centre + 0.5) * scale) - std::erf((from_centre - 0.5) * scale));
  }

  FakeBenchTruth truth_;
  BenchModel model_;
  twins::camera::Optics camera_;
  Picture counts_;
  std::vector<fsw::Vector2> places_;
  std::vector<double> evenness_;
  std::vector<std::size_t> hot_;
  std::mt19937 random_{7};
  std::normal_distribution<double> normal_;
  double display_mm_ = 0.0;
  bool is_homed_ = false;
};

}  // namespace vbar::optical_stimulator
