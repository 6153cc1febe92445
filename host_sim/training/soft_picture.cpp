#include "host_sim/training/soft_picture.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace vbar::training {
namespace {

std::vector<float> kernel_of(double sigma_px) {
  const int reach = static_cast<int>(std::ceil(3.5 * sigma_px));
  std::vector<double> weights;
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    weights.push_back(std::exp(-0.5 * k * k / (sigma_px * sigma_px)));
    sum += weights.back();
  }
  std::vector<float> kernel;
  for (const double weight : weights) kernel.push_back(static_cast<float>(weight / sum));
  return kernel;
}

}  // namespace

void soften(double sigma_px, int width, int height, std::vector<float>& picture) {
  if (!(sigma_px >= 0.05)) return;
  const std::vector<float> kernel = kernel_of(sigma_px);
  const int reach = static_cast<int>(kernel.size() / 2);
  std::vector<float> across(picture.size(), 0.0F);
  for (int y = 0; y < height; ++y) {
    const float* const from = picture.data() + static_cast<std::ptrdiff_t>(y) * width;
    float* const to = across.data() + static_cast<std::ptrdiff_t>(y) * width;
    for (int k = -reach; k <= reach; ++k) {
      const float weight = kernel[static_cast<std::size_t>(k + reach)];
      const int first = std::max(0, k), last = std::min(width, width + k);
      for (int x = first; x < last; ++x) to[x] += weight * from[x - k];
    }
  }
  std::fill(picture.begin(), picture.end(), 0.0F);
  for (int y = 0; y < height; ++y) {
    float* const to = picture.data() + static_cast<std::ptrdiff_t>(y) * width;
    for (int k = std::max(-reach, y - height + 1); k <= std::min(reach, y); ++k) {
      const float weight = kernel[static_cast<std::size_t>(k + reach)];
      const float* const from = across.data() + static_cast<std::ptrdiff_t>(y - k) * width;
      for (int x = 0; x < width; ++x) to[x] += weight * from[x];
    }
  }
}

}  // namespace vbar::training
