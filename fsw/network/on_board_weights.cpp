#include <cstdint>

#include "fsw/network/keypoint_network.h"

// Positions set by the linker (on_board_weights.S).
extern "C" {
extern const std::byte vbar_keypoint_weights[];
extern const std::uint32_t vbar_keypoint_weights_bytes;
}

namespace vbar::fsw::network {

std::span<const std::byte> weights_on_board() {
  return {vbar_keypoint_weights, vbar_keypoint_weights_bytes};
}

}  // namespace vbar::fsw::network
