#pragma once
// Weights and a crop at the lower end of what there can be, from integers only: the same on every machine.

#include <cstdint>

#include "fsw/network/keypoint_network.h"
#include "tests/unit/fsw/network/network_file.h"
#include "tests/unit/fsw/same_bits/digest.h"

namespace vbar::test {

/// Most weights are nothing, so that small numbers are not lost in sums with larger ones. In a sum some are of the size
/// 1 and positive, so that numbers live on from layer to layer, and some of the smallest there can be.
inline WeightsFile tiny_file(std::uint64_t seed) {
  same_bits::Arguments arguments(seed);
  return file_of([&](const fsw::network::Layer& layer, std::size_t k) {
    if (k >= layer.weights()) return 0.0;  // a bias would cover all else
    const double alive = layer.is_rectified ? 2.0 : 0.7;
    const double term = arguments.between(0.0, layer.kernel * layer.kernel * layer.in);
    if (term < alive) return arguments.between(0.5, 1.0);
    if (term < alive + 0.7) return arguments.magnitude(-40, -30);
    return 0.0;
  });
}

/// Sizes on both sides of the least that is taken in, and denormal ones.
inline Crop tiny_crop(std::uint64_t seed) {
  same_bits::Arguments arguments(seed);
  Crop crop;
  for (float& sample : crop) {
    const bool is_denormal = arguments.between(0.0, 1.0) < 0.1;
    sample = static_cast<float>(is_denormal ? arguments.magnitude(-140, -130) : arguments.magnitude(-95, -50));
  }
  return crop;
}

}  // namespace vbar::test
