#pragma once
// Conversion of the counts of a display to its luminance.
//
//   L(D) = L_full ((D - D0)/(255 - D0))^gamma (D > D0)  + L_full / contrast,   times the evenness of the pixel

#include <array>
#include <cstdint>

#include "host_sim/engine/random_stream.h"

namespace vbar::optical_stimulator::bench {

struct DisplayLight {
  double full_luminance = 200.0;  ///< cd/m^2
  double gamma = 2.2;
  double first_count = 3.0;  ///< D0: up to it no light
  double contrast = 1e5;
  double pixel_unevenness = 0.02;  ///< one sigma, relative

  /// Returns the luminance above the black level, cd/m^2.
  [[nodiscard]] double luminance(double count) const;
  [[nodiscard]] double black_luminance() const { return full_luminance / contrast; }
};

/// Number of counts that a display shows.
inline constexpr std::size_t kCounts = 256;
using CountTable = std::array<float, kCounts>;
[[nodiscard]] CountTable luminance_table(const DisplayLight& light);

/// Holds the light of single pixels relative to their neighbourhood.
class PixelEvenness {
 public:
  PixelEvenness(double sigma, std::uint64_t seed) : sigma_(sigma), stream_(seed, "bench/display/pixels") {}
  [[nodiscard]] double of(std::uint64_t pixel) const;

 private:
  double sigma_;
  engine::RandomStream stream_;
};

/// Returns photons/m^2 at the camera in a second per lux of illuminance: a star of magnitude 0 is 2.54e-6 lx (Allen
/// 1973, rounded) and radiates `zero_magnitude_photons`.
[[nodiscard]] constexpr double photons_per_lux(double zero_magnitude_photons) {
  return zero_magnitude_photons / 2.54e-6;
}

}  // namespace vbar::optical_stimulator::bench
