#include "fsw/guard/apparent_size.h"

#include "fsw/math/math.h"

namespace vbar::fsw::guard {
namespace {

constexpr double kLitShare = 0.05;  // of the range from dark to saturated
constexpr int kFewestPixels = 60;
constexpr int kMostRimPixels = 4;  // hot pixels
constexpr double kSmallestCosPhase = -0.342;

bool is_lit(std::uint16_t pixel, double threshold_dn) {
  return pixel != imaging::kMissingPixel && static_cast<double>(pixel) > threshold_dn;
}

}  // namespace

LitArea lit_area(const imaging::ImageView& image, const GuardCamera& camera) {
  const double threshold_dn = camera.dark_level_dn + kLitShare * (camera.saturation_dn - camera.dark_level_dn);
  LitArea area;
  int on_rim = 0;
  std::size_t k = 0;
  for (int y = 0; y < image.frame.height; ++y) {
    for (int x = 0; x < image.frame.width && k < image.pixels.size(); ++x, ++k) {
      if (!is_lit(image.pixels[k], threshold_dn)) continue;
      ++area.pixels;
      const bool is_rim = x == 0 || y == 0 || x == image.frame.width - 1 || y == image.frame.height - 1;
      if (is_rim) ++on_rim;
    }
  }
  area.is_cut = on_rim > kMostRimPixels;
  return area;
}

std::optional<double> range_from_size(const LitArea& area, const GuardCamera& camera, const Illumination& illumination,
                                      double target_size_m) {
  const double cos_phase = -illumination.line_of_sight.dot(illumination.to_sun);
  if (area.is_cut || area.pixels < kFewestPixels || !(cos_phase >= kSmallestCosPhase)) return std::nullopt;
  const double lit_size_m = target_size_m * math::sqrt(0.5 * (1.0 + cos_phase));
  return camera.focal_length_px * lit_size_m / math::sqrt(static_cast<double>(area.pixels));
}

}  // namespace vbar::fsw::guard
