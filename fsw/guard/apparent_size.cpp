#include "fsw/guard/apparent_size.h"

#include <array>

#include "fsw/math/math.h"

namespace vbar::fsw::guard {
namespace {

constexpr double kLitShare = 1.0 / 12.0;  // threshold as a share of the brightness of the brightest pixels
constexpr int kBrightest = 60;            // number of pixels, larger than that of hot pixels
constexpr double kMinSigmas = 60.0;       // smallest brightness of these, in sigmas of the noise
constexpr double kThresholdSigmas = 6.0;
constexpr int kMinPixels = 300;
constexpr int kMaxRimPixels = 4;  // hot pixels
constexpr double kMinCosPhase = 0.0;
// Share of a silhouette's size that is brighter than the threshold, measured on Tango.
constexpr double kBrightShare = 0.9;
constexpr std::size_t kLevels = 4096;  // of 12 bits

/// Returns the brightness that kBrightest pixels exceed or reach.
int brightest_dn(const imaging::ImageView& image) {
  std::array<int, kLevels> histogram{};
  for (const std::uint16_t pixel : image.pixels) {
    if (pixel < kLevels) ++histogram[pixel];
  }
  int count = 0;
  for (std::size_t level = kLevels; level-- > 0;) {
    count += histogram[level];
    if (count >= kBrightest) return static_cast<int>(level);
  }
  return 0;
}

}  // namespace

LitArea lit_area(const imaging::ImageView& image, const GuardCamera& camera) {
  const double brightness_dn = brightest_dn(image) - camera.dark_level_dn;
  LitArea area;
  if (!(brightness_dn > kMinSigmas * camera.noise_dn)) return area;
  const double share_dn = kLitShare * brightness_dn;
  const double noise_dn = kThresholdSigmas * camera.noise_dn;
  const double threshold_dn = camera.dark_level_dn + (share_dn > noise_dn ? share_dn : noise_dn);
  int on_rim = 0;
  std::size_t k = 0;
  for (int y = 0; y < image.frame.height; ++y) {
    for (int x = 0; x < image.frame.width && k < image.pixels.size(); ++x, ++k) {
      const std::uint16_t pixel = image.pixels[k];
      if (pixel == imaging::kMissingPixel || !(pixel > threshold_dn)) continue;
      ++area.pixels;
      const bool is_rim = x == 0 || y == 0 || x == image.frame.width - 1 || y == image.frame.height - 1;
      if (is_rim) ++on_rim;
    }
  }
  area.is_cut = on_rim > kMaxRimPixels;
  return area;
}

std::optional<double> range_from_size(const LitArea& area, const GuardCamera& camera, const Illumination& illumination,
                                      double target_size_m) {
  const double cos_phase = -illumination.line_of_sight.dot(illumination.to_sun);
  if (area.is_cut || area.pixels < kMinPixels || !(cos_phase >= kMinCosPhase)) return std::nullopt;
  const double lit_size_m = kBrightShare * target_size_m * math::sqrt(0.5 * (1.0 + cos_phase));
  return camera.focal_length_px * lit_size_m / math::sqrt(static_cast<double>(area.pixels));
}

}  // namespace vbar::fsw::guard
