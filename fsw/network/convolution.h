#pragma once
// Convolution of a feature map with a layer's kernels.
//
// Every output value is one sum: its bias, then the products in the order of the weights file, rows of the kernel, its
// columns, channels in. Four output channels are four lanes; eight of them, over four cells of a row, are computed
// together, so that loaded values are reused. An x86 processor with wider registers holds more channels in one register
// (strip.h).

#include <array>
#include <cstddef>
#include <span>

#include "fsw/network/architecture.h"
#include "fsw/network/feature_map.h"
#include "fsw/network/registers.h"

namespace vbar::fsw::network {

inline constexpr int kPanelChannels = 8;

/// The weights of eight output channels, contiguous: they are read once for each four cells.
struct WeightPanel {
  static constexpr std::size_t kRows = 9 * 128;

  alignas(16) std::array<float, kRows * kPanelChannels> weights{};
  alignas(16) std::array<float, kPanelChannels> biases{};
};

/// Computes out = rectified convolution of in. `weights` are the layer's bytes in the file. The shapes must be the
/// layer's: as many channels, out.side = in.side / stride a multiple of eight. The computer must have `registers`.
void convolve_rectified(const Layer& layer, std::span<const std::byte> weights, const FeatureMap& in,
                        const FeatureMap& out, WeightPanel& panel, Registers registers);

/// Adds the convolution of in to sum: each cell of in to two by two cells of sum, which has twice its side.
void convolve_and_add_enlarged(const Layer& layer, std::span<const std::byte> weights, const FeatureMap& in,
                               const FeatureMap& sum, WeightPanel& panel, Registers registers);

/// Writes the convolution of in, channel by channel, rows from the top; channels beyond the heatmaps are left out.
void convolve_to_maps(const Layer& layer, std::span<const std::byte> weights, const FeatureMap& in,
                      std::span<std::array<float, kMapCells>> maps, WeightPanel& panel, Registers registers);

}  // namespace vbar::fsw::network
