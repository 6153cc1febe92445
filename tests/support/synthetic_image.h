#pragma once
// Images as a detector would give them, from first principles and nothing of the project's: Gaussian images of points
// integrated over each pixel (error function), smeared in steps, with Poisson light, Gaussian read noise, a gain, an
// offset and a full well. For tests of image processing.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "fsw/vision/imaging/image.h"

namespace vbar::test {

struct SyntheticDetector {
  double gain_dn_per_electron = 0.125;
  double read_noise_electrons = 7.0;
  double dark_electrons = 1.0;
  double offset_dn = 64.0;
  double full_well_electrons = 32000.0;
  int most_dn = 4095;
  bool has_photon_noise = true;
};

struct Point {
  double x = 0.0, y = 0.0;  ///< px, an integer is the centre of a pixel
  double electrons = 0.0;
  double sigma_px = 0.8;  ///< before the pixel's own width
  double smear_x_px = 0.0, smear_y_px = 0.0;
};

class SyntheticImage {
 public:
  SyntheticImage(int width, int height)
      : width_(width),
        height_(height),
        electrons_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0.0) {}

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] double& at(int x, int y) {
    return electrons_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
  }

  void add(const Point& point) {
    const double smear = std::hypot(point.smear_x_px, point.smear_y_px);
    const int steps = smear > 0.0 ? 16 : 1;
    for (int k = 0; k < steps; ++k) {
      const double part = (k + 0.5) / steps - 0.5;
      add_unsmeared(point, point.x + part * point.smear_x_px, point.y + part * point.smear_y_px,
                    point.electrons / steps);
    }
  }

  /// electrons(x, y) added to every pixel.
  template <class Function>
  void add_light(Function electrons) {
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) at(x, y) += electrons(x, y);
    }
  }

  /// Raw pixels of one exposure.
  [[nodiscard]] std::vector<std::uint16_t> expose(const SyntheticDetector& detector, std::mt19937_64& random) const {
    std::normal_distribution<double> normal;
    std::vector<std::uint16_t> pixels;
    pixels.reserve(electrons_.size());
    for (const double light : electrons_) {
      const double mean = light + detector.dark_electrons;
      double charge = mean;
      if (detector.has_photon_noise && mean > 50.0) {
        charge = mean + std::sqrt(mean) * normal(random);
      } else if (detector.has_photon_noise && mean > 0.0) {
        charge = static_cast<double>(std::poisson_distribution<int>(mean)(random));
      }
      charge = std::min(charge, detector.full_well_electrons) + detector.read_noise_electrons * normal(random);
      const double dn = std::round(detector.offset_dn + detector.gain_dn_per_electron * charge);
      pixels.push_back(static_cast<std::uint16_t>(std::clamp(dn, 0.0, static_cast<double>(detector.most_dn))));
    }
    return pixels;
  }

 private:
  void add_unsmeared(const Point& point, double x, double y, double electrons) {
    const int reach = static_cast<int>(std::ceil(8.0 * point.sigma_px)) + 1;
    const auto part = [&](int pixel, double centre) {
      const double scale = 1.0 / (std::sqrt(2.0) * point.sigma_px);
      return 0.5 * (std::erf((pixel + 0.5 - centre) * scale) - std::erf((pixel - 0.5 - centre) * scale));
    };
    const int cx = static_cast<int>(std::lround(x));
    const int cy = static_cast<int>(std::lround(y));
    for (int j = std::max(0, cy - reach); j <= std::min(height_ - 1, cy + reach); ++j) {
      for (int i = std::max(0, cx - reach); i <= std::min(width_ - 1, cx + reach); ++i) {
        at(i, j) += electrons * part(i, x) * part(j, y);
      }
    }
  }

  int width_;
  int height_;
  std::vector<double> electrons_;
};

/// A view of pixels that the caller keeps.
inline fsw::imaging::ImageView view_of(const std::vector<std::uint16_t>& pixels, int width, int height,
                                       int origin_x = 0, int origin_y = 0) {
  return {{.width = width, .height = height, .origin_x = origin_x, .origin_y = origin_y, .bits = 12}, pixels};
}

}  // namespace vbar::test
