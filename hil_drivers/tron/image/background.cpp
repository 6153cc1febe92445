#include "hil_drivers/tron/image/background.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "host_sim/twins/camera/pixel_noise.h"

namespace vbar::tron {

DarkLevel dark_level(std::span<const std::uint16_t> dn) {
  if (dn.size() < 100) throw std::invalid_argument("a dark image of fewer than 100 pixels");
  std::vector<std::uint16_t> sorted(dn.begin(), dn.end());
  std::ranges::sort(sorted);
  // Moments of the middle two thirds, so that hot pixels and rounding to whole numbers do not matter. A normal
  // distribution cut off at its sixths has 0.5365 of its standard deviation left.
  constexpr double kOfMiddle = 0.5365;
  const std::size_t sixth = sorted.size() / 6;
  double sum = 0.0, squares = 0.0;
  const auto middle = std::span(sorted).subspan(sixth, sorted.size() - 2 * sixth);
  for (const std::uint16_t value : middle) sum += value;
  const double mean = sum / static_cast<double>(middle.size());
  for (const std::uint16_t value : middle) squares += (value - mean) * (value - mean);
  // Rounding adds 1/12 to the variance, and the noise that is drawn is rounded again.
  const double deviation = std::sqrt(squares / static_cast<double>(middle.size())) / kOfMiddle;
  return {mean, std::sqrt(std::max(0.0, deviation * deviation - 1.0 / 12.0))};
}

std::vector<std::uint8_t> grown(std::span<const float> covered, int width, int radius_px, float least) {
  const int height = static_cast<int>(covered.size()) / width;
  const auto at = [width](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  };
  std::vector<std::uint8_t> mask(covered.size(), 0);
  const auto is_covered = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < width && y < height && covered[at(x, y)] >= least;
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (!is_covered(x, y)) continue;
      mask[at(x, y)] = 1;
      // Only the edge has anything to add.
      if (is_covered(x - 1, y) && is_covered(x + 1, y) && is_covered(x, y - 1) && is_covered(x, y + 1)) continue;
      for (int dy = -radius_px; dy <= radius_px; ++dy) {
        if (y + dy < 0 || y + dy >= height) continue;
        const int reach = static_cast<int>(std::sqrt(static_cast<double>(radius_px * radius_px - dy * dy)));
        const int first = std::max(0, x - reach), last = std::min(width - 1, x + reach);
        std::fill(mask.begin() + static_cast<std::ptrdiff_t>(at(first, y + dy)),
                  mask.begin() + static_cast<std::ptrdiff_t>(at(last, y + dy)) + 1, std::uint8_t{1});
      }
    }
  return mask;
}

std::vector<std::uint8_t> TargetMask::draw(const twins::camera::Projection& lens, const Eigen::Isometry3d& T_C_B,
                                           const twins::camera::Region& region) {
  silhouette_.draw(lens, T_C_B.translation(), T_C_B.linear(), region, covered_);
  return grown(covered_, region.width, kMargin_px);
}

void replace_background(std::span<const std::uint8_t> mask, const DarkLevel& dark, std::uint64_t key,
                        std::int64_t image, std::uint16_t full_scale_dn, std::span<std::uint16_t> dn) {
  using namespace twins::camera;
  if (mask.size() != dn.size()) throw std::invalid_argument("a mask of another size than the image");
  ChunkWords words;
  ChunkFloats normal;
  for (std::size_t first = 0; first < dn.size(); first += kChunk) {
    const std::size_t count = std::min(kChunk, dn.size() - first);
    const auto masked = mask.subspan(first, count);
    if (std::ranges::find(masked, std::uint8_t{0}) == masked.end()) continue;
    draw_words({key, static_cast<std::uint64_t>(image)}, NoiseKind::kRead, static_cast<std::uint32_t>(first / kChunk),
               words);
    normal_numbers(words, normal);
    for (std::size_t k = 0; k < count; ++k)
      if (masked[k] == 0)
        dn[first + k] = static_cast<std::uint16_t>(
            std::clamp(std::lround(dark.offset_dn + dark.noise_dn * static_cast<double>(normal[k])), 0L,
                       static_cast<long>(full_scale_dn)));
  }
}

}  // namespace vbar::tron
