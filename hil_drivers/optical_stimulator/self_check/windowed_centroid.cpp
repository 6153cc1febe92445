#include "hil_drivers/optical_stimulator/self_check/windowed_centroid.h"

#include <cmath>

namespace vbar::optical_stimulator {
namespace {

constexpr int kReach_px = 6;
constexpr int kSteps = 20;

}  // namespace

std::optional<Spot> windowed_centroid(std::span<const std::uint16_t> dn, int width, const fsw::Vector2& near,
                                      double background_dn, double sigma_px, double least_dn) {
  const int height = static_cast<int>(dn.size() / static_cast<std::size_t>(width));
  const auto x0 = static_cast<int>(std::lround(near.x())), y0 = static_cast<int>(std::lround(near.y()));
  if (x0 < kReach_px || y0 < kReach_px || x0 >= width - kReach_px || y0 >= height - kReach_px) return std::nullopt;
  Spot spot{near, 0.0};
  for (int step = 0; step < kSteps; ++step) {
    double weights = 0.0, sum = 0.0;
    fsw::Vector2 offset = fsw::Vector2::Zero();
    for (int y = y0 - kReach_px; y <= y0 + kReach_px; ++y)
      for (int x = x0 - kReach_px; x <= x0 + kReach_px; ++x) {
        const double light =
            dn[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] -
            background_dn;
        const fsw::Vector2 from = fsw::Vector2(x, y) - spot.centre;
        const double weighted = light * std::exp(-0.5 * from.squaredNorm() / (sigma_px * sigma_px));
        sum += light;
        weights += weighted;
        offset += weighted * from;
      }
    if (!(sum >= least_dn) || !(weights > 0.0)) return std::nullopt;
    spot.dn = sum;
    const fsw::Vector2 change = 2.0 * offset / weights;
    spot.centre += change;
    if ((spot.centre - near).lpNorm<Eigen::Infinity>() > kReach_px) return std::nullopt;
    if (change.norm() < 1e-5) break;
  }
  return spot;
}

}  // namespace vbar::optical_stimulator
