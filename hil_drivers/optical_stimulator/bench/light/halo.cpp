#include "hil_drivers/optical_stimulator/bench/light/halo.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace vbar::optical_stimulator::bench {
namespace {

constexpr std::size_t kBin = 4;

std::vector<float> kernel_of(double sigma) {
  const int reach = std::max(1, static_cast<int>(std::ceil(4.0 * sigma)));
  std::vector<float> kernel;
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k) sum += std::exp(-0.5 * k * k / (sigma * sigma));
  for (int k = -reach; k <= reach; ++k)
    kernel.push_back(static_cast<float>(std::exp(-0.5 * k * k / (sigma * sigma)) / sum));
  return kernel;
}

/// Along one direction of a grid: `count` places `step` apart.
void smooth_line(std::span<const float> kernel, const float* from, float* to, std::size_t count, std::size_t step) {
  const std::size_t reach = kernel.size() / 2;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t first = k > reach ? k - reach : 0, last = std::min(count - 1, k + reach);
    float sum = 0.0F;
    for (std::size_t j = first; j <= last; ++j) sum += kernel[j + reach - k] * from[j * step];
    to[k * step] = sum;
  }
}

}  // namespace

void spread_halo(double fraction, double sigma_px, twins::camera::PhotonImage& image, std::vector<float>& work) {
  if (!(fraction > 0.0) || image.electrons.empty()) return;
  const auto width = static_cast<std::size_t>(image.region.width);
  const auto height = static_cast<std::size_t>(image.region.height);
  const std::size_t columns = (width + kBin - 1) / kBin, rows = (height + kBin - 1) / kBin;
  work.assign(2 * columns * rows, 0.0F);
  float* sums = work.data();
  float* smoothed = sums + columns * rows;
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) sums[y / kBin * columns + x / kBin] += image.electrons[y * width + x];
  // Summing over 4 pixels widens by (4^2 - 1)/12 and linear interpolation by 4^2/6.
  const double variance = std::max(0.25, sigma_px * sigma_px - 15.0 / 12.0 - 16.0 / 6.0);
  const std::vector<float> kernel = kernel_of(std::sqrt(variance) / kBin);
  for (std::size_t row = 0; row < rows; ++row)
    smooth_line(kernel, sums + row * columns, smoothed + row * columns, columns, 1);
  for (std::size_t column = 0; column < columns; ++column)
    smooth_line(kernel, smoothed + column, sums + column, rows, columns);

  const auto kept = static_cast<float>(1.0 - fraction);
  const auto gain = static_cast<float>(fraction / (kBin * kBin));
  constexpr float kFirst = 0.5F / kBin - 0.5F;  // place of a block's first pixel between the blocks' centres
  const auto neighbours = [](std::size_t pixel, std::size_t count, std::size_t& low, std::size_t& high) {
    const float place = std::clamp(kFirst + static_cast<float>(pixel) / kBin, 0.0F, static_cast<float>(count - 1));
    low = static_cast<std::size_t>(place);
    high = std::min(low + 1, count - 1);
    return place - static_cast<float>(low);
  };
  for (std::size_t y = 0; y < height; ++y) {
    std::size_t above = 0, below = 0;
    const float ty = neighbours(y, rows, above, below);
    for (std::size_t x = 0; x < width; ++x) {
      std::size_t left = 0, right = 0;
      const float tx = neighbours(x, columns, left, right);
      const float a =
          sums[above * columns + left] + tx * (sums[above * columns + right] - sums[above * columns + left]);
      const float b =
          sums[below * columns + left] + tx * (sums[below * columns + right] - sums[below * columns + left]);
      float& electrons = image.electrons[y * width + x];
      electrons = kept * electrons + gain * (a + ty * (b - a));
    }
  }
}

}  // namespace vbar::optical_stimulator::bench
