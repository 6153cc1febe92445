#pragma once
// Sizes of the input and output of the keypoint network.

#include <cstddef>

namespace vbar::fsw::pose {

inline constexpr int kInputSide = 128;  ///< samples of the crop
inline constexpr int kMapSide = 32;     ///< cells
inline constexpr int kKeypoints = 11;
inline constexpr std::size_t kInputSamples = static_cast<std::size_t>(kInputSide) * kInputSide;
inline constexpr std::size_t kMapCells = static_cast<std::size_t>(kMapSide) * kMapSide;

}  // namespace vbar::fsw::pose
