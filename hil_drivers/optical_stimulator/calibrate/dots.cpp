#include "hil_drivers/optical_stimulator/calibrate/dots.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vbar::optical_stimulator::calibrate {

using fsw::Vector2;

double Response::luminance(double count) const {
  return count > first_count ? std::pow((count - first_count) / (255.0 - first_count), gamma) : 0.0;
}

std::uint8_t Response::nearest_count(double luminance_wanted) const {
  if (!(luminance_wanted > 0.0)) return 0;
  const double exact = first_count + (255.0 - first_count) * std::pow(luminance_wanted, 1.0 / gamma);
  const double below = std::clamp(std::floor(exact), 0.0, 254.0);
  const bool is_lower = luminance_wanted - luminance(below) < luminance(below + 1.0) - luminance_wanted;
  return static_cast<std::uint8_t>(is_lower ? below : below + 1.0);
}

std::optional<DrawnDot> draw_dot(Picture& counts, const Vector2& centre_px, double sigma_px, double full_pixels,
                                 const Response& response) {
  constexpr int kHalf = 3;
  const int cx = static_cast<int>(std::lround(centre_px.x())), cy = static_cast<int>(std::lround(centre_px.y()));
  if (cx < kHalf || cy < kHalf || cx >= counts.width - kHalf || cy >= counts.height - kHalf) return std::nullopt;
  std::array<double, 49> weight{};
  double weights = 0.0;
  const auto weight_at = [&](int dx, int dy) {
    return std::exp(-0.5 * (Vector2(cx + dx, cy + dy) - centre_px).squaredNorm() / (sigma_px * sigma_px));
  };
  for (int dy = -kHalf; dy <= kHalf; ++dy)
    for (int dx = -kHalf; dx <= kHalf; ++dx)
      weights += weight[static_cast<std::size_t>(7 * (dy + 3) + dx + 3)] = weight_at(dx, dy);
  DrawnDot drawn{Vector2::Zero(), 0.0};
  for (int dy = -kHalf; dy <= kHalf; ++dy)
    for (int dx = -kHalf; dx <= kHalf; ++dx) {
      const double wanted = full_pixels * weight[static_cast<std::size_t>(7 * (dy + 3) + dx + 3)] / weights;
      const std::uint8_t count = response.nearest_count(wanted);
      counts.at(cx + dx, cy + dy) = count;
      const double luminance = response.luminance(count);
      drawn.full_pixels += luminance;
      drawn.centre_px += luminance * Vector2(cx + dx, cy + dy);
    }
  if (!(drawn.full_pixels > 0.0)) return std::nullopt;
  drawn.centre_px /= drawn.full_pixels;
  return drawn;
}

DrawnDot draw_square(Picture& counts, int x, int y, int half_width, std::uint8_t count, const Response& response) {
  for (int row = std::max(0, y - half_width); row <= std::min(counts.height - 1, y + half_width); ++row)
    for (int column = std::max(0, x - half_width); column <= std::min(counts.width - 1, x + half_width); ++column)
      counts.at(column, row) = count;
  const double side = 2.0 * half_width + 1.0;
  return {Vector2(x, y), side * side * response.luminance(count)};
}

}  // namespace vbar::optical_stimulator::calibrate
