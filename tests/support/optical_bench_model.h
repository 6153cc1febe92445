#pragma once
// The optics of a bench, from the display to the directions: independent of the display map, whose inverse it is. It
// has lens terms on the display's side and a smooth field that no lens model represents (a sum of plane waves).

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/types.h"

namespace vbar::optical_stimulator {

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

}  // namespace vbar::optical_stimulator
