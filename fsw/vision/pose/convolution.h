#pragma once
// Convolution of a feature map with a layer's kernels.
//
// Every output value is one sum: its bias, then the products in the order of the weights file, rows of the kernel, its
// columns, channels in. Four output channels are four lanes; eight of them, over four cells of a row, are computed
// together, so that loaded values are reused. An x86 processor with wider registers holds more channels in one register
// (convolution.h).

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/vision/pose/architecture.h"
#include "fsw/vision/pose/feature_map.h"

namespace vbar::fsw::pose {

// Vector registers of a convolution, by the single-precision numbers that one holds.

/// Numbers in a register. Every target has registers of four. The sums have the same bits with each: a lane is one
/// output channel, with the same operations in the same order (convolution.h).
enum class Registers : std::uint8_t { kFour = 4, kEight = 8, kSixteen = 16 };

/// Returns the widest registers of this computer and its operating system. Wider ones than four exist on x86 only
/// (AVX2, AVX-512).
Registers widest_registers();

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

// Sums of a convolution in registers wider than four numbers, which x86 has.
//
// Every sum is its bias, then the products in the order of the weights file, each product and each sum rounded: what
// four lanes compute (convolution.cpp), bit by bit. FMA, which these processors have too, rounds once and is not used.

/// A row of output cells, a multiple of eight, and all their channels, a multiple of four.
struct Strip {
  const float* first = nullptr;  ///< first channel under the first cell's kernel
  std::ptrdiff_t row_step = 0;
  std::ptrdiff_t cell_step = 0;        ///< from one output cell to the next
  int rows = 0;                        ///< rows of the kernel
  int run = 0;                         ///< values of a kernel's row: its columns and their channels are contiguous
  const std::byte* weights = nullptr;  ///< weights of the layer, as the file has them
  const std::byte* biases = nullptr;
  int cells = 0;
  int channels = 0;
  float* sums = nullptr;  ///< [cell][channel]
};

#if defined(__x86_64__)
/// Computes the sums on a processor that has AVX2.
void sum_strip_avx2(const Strip& strip);
/// Computes the sums on a processor that has AVX-512 F.
void sum_strip_avx512(const Strip& strip);
#endif

}  // namespace vbar::fsw::pose
