#pragma once
// The channels of a layer over the image plane, and their memory.

#include <array>
#include <cstddef>

namespace vbar::fsw::pose {

/// Numbers of the channels over the image plane: rows from the top, cells from the left, channels of a cell contiguous.
/// They are surrounded by a border of one cell, which stays 0: the zero padding of the kernels.
struct FeatureMap {
  float* numbers = nullptr;  ///< first number of the border's first cell
  int side = 0;              ///< cells, without the border
  int channels = 0;

  [[nodiscard]] std::ptrdiff_t row_step() const { return static_cast<std::ptrdiff_t>(side + 2) * channels; }
  /// Returns the channels of a cell; -1 and `side` are the border.
  [[nodiscard]] float* cell(int row, int column) const {
    return numbers + (row + 1) * row_step() + static_cast<std::ptrdiff_t>(column + 1) * channels;
  }
};

template <int kSide, int kChannels>
struct FeatureStore {
  alignas(16) std::array<float, static_cast<std::size_t>((kSide + 2) * (kSide + 2) * kChannels)> numbers{};

  FeatureMap map() { return {.numbers = numbers.data(), .side = kSide, .channels = kChannels}; }
};

}  // namespace vbar::fsw::pose
