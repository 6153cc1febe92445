#pragma once
// Images of the close-range camera from first principles: a bright box for the target, stars, hot pixels, the Earth's
// limb, stray light.

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "fsw/vision/imaging/image.h"
#include "tests/support/synthetic_image.h"

namespace vbar::test {

inline constexpr int kCloseWidth = 800;
inline constexpr int kCloseHeight = 500;

/// 2 x 2 binned: four times the full well behind 12 bits.
inline SyntheticDetector close_detector() {
  return {.gain_dn_per_electron = 0.03125,
          .read_noise_electrons = 14.0,
          .dark_electrons = 0.0,
          .offset_dn = 64.0,
          .full_well_electrons = 128000.0};
}

inline constexpr double kCloseNoiseDn = 0.53;  ///< read noise of 14 electrons and rounding to whole DN

/// A rectangle turned in the image, lit in two halves.
struct LitBox {
  double x = 400.0, y = 250.0;
  double width = 150.0, height = 110.0;
  double turn = 0.4;
  double bright_electrons = 40000.0;
  double shadow_electrons = 40000.0;
};

class CloseImage {
 public:
  explicit CloseImage(std::uint64_t seed) : random_(seed) {}

  CloseImage& box(const LitBox& b) {
    image_.add_light([&b](int x, int y) {
      const double u = std::cos(b.turn) * (x - b.x) + std::sin(b.turn) * (y - b.y);
      const double v = -std::sin(b.turn) * (x - b.x) + std::cos(b.turn) * (y - b.y);
      if (std::abs(u) > 0.5 * b.width || std::abs(v) > 0.5 * b.height) return 0.0;
      return u > 0.0 ? b.bright_electrons : b.shadow_electrons;
    });
    return *this;
  }
  CloseImage& stars_and_hot_pixels() {
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (int k = 0; k < 60; ++k) {
      image_.add({kCloseWidth * uniform(random_), kCloseHeight * uniform(random_), 3000.0 / (0.02 + uniform(random_))});
    }
    for (int k = 0; k < 20; ++k) image_.at(random_place(kCloseWidth), random_place(kCloseHeight)) += 60000.0;
    return *this;
  }
  /// Below a line that falls to the right.
  CloseImage& limb(double height_px, double electrons) {
    image_.add_light([&](int x, int y) { return y > kCloseHeight - height_px + 0.1 * x ? electrons : 0.0; });
    return *this;
  }
  /// Falls off to the right.
  CloseImage& stray_light(double most_electrons) {
    image_.add_light([&](int x, int) { return most_electrons * std::exp(-x / 400.0); });
    return *this;
  }
  CloseImage& even_light(double electrons) {
    image_.add_light([&](int, int) { return electrons; });
    return *this;
  }

  [[nodiscard]] std::vector<std::uint16_t> expose() { return image_.expose(close_detector(), random_); }

 private:
  int random_place(int size) { return static_cast<int>(random_() % static_cast<std::uint64_t>(size)); }

  std::mt19937_64 random_;
  SyntheticImage image_{kCloseWidth, kCloseHeight};
};

}  // namespace vbar::test
