#pragma once
// A digest of the keypoint network's maps, of the weights on board and of weights and samples so small that a processor
// which flushes denormal numbers would show it.

#include <cstdint>
#include <memory>

#include "fsw/vision/pose/keypoint_network.h"
#include "tests/unit/fsw/same_bits/digest.h"
#include "tests/unit/fsw/vision/pose/plain_network.h"

namespace vbar::same_bits {

inline void add_maps(Digest& digest, std::span<const std::byte> weights, const test::Crop& crop) {
  const auto network = std::make_unique<fsw::pose::KeypointNetwork>();
  digest.add(static_cast<double>(network->load(weights)));
  digest.add(static_cast<double>(network->run(crop)));
  for (int k = 0; k < fsw::pose::kKeypoints; ++k) {
    for (const float logit : network->logits(k)) digest.add(static_cast<double>(logit));
  }
}

inline std::uint64_t network_digest() {
  Digest digest;
  add_maps(digest, fsw::pose::weights_on_board(), test::structured_crop());
  add_maps(digest, test::tiny_file(8), test::tiny_crop(8));
  return digest.value();
}

}  // namespace vbar::same_bits
