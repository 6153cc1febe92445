#pragma once
// The layers of the keypoint network, their positions in a weights file, and the bounds of its numbers.
//
// A weights file of data/networks, little endian:
//
//   16 bytes     "vbar keypoints 2"
//   4 u32        layers (13), side of the input (128), side of the heatmaps (32), keypoints (11)
//   13 x 8 u32   a layer: channels in, channels out, side of the kernel, stride, 1 if rectified, 0, 0, 0
//   8 f32        calibration: covariance_scale, covariance_floor, target_sigma_cells, least_peak, stretch, 0, 0, 0
//   per layer    f32 weights [row of the kernel][column][channel in][channel out], then f32 biases [channel out]
//   u32          CRC-32 (IEEE 802.3) of everything before

#include <array>
#include <cstddef>
#include <cstdint>

namespace vbar::fsw::pose {

// Sizes of the input and output of the keypoint network.

inline constexpr int kInputSide = 128;  ///< samples of the crop
inline constexpr int kMapSide = 32;     ///< cells
inline constexpr int kKeypoints = 11;
inline constexpr std::size_t kInputSamples = static_cast<std::size_t>(kInputSide) * kInputSide;
inline constexpr std::size_t kMapCells = static_cast<std::size_t>(kMapSide) * kMapSide;

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "weights are used as the file has them");

struct Layer {
  int in = 0;   ///< channels
  int out = 0;  ///< channels
  int kernel = 1;
  int stride = 1;
  bool is_rectified = true;

  [[nodiscard]] constexpr std::size_t weights() const {
    return static_cast<std::size_t>(kernel) * static_cast<std::size_t>(kernel) * static_cast<std::size_t>(in) *
           static_cast<std::size_t>(out);
  }
  /// Number of bytes in a file, biases included.
  [[nodiscard]] constexpr std::size_t bytes() const {
    return sizeof(float) * (weights() + static_cast<std::size_t>(out));
  }
};

inline constexpr int kLayerCount = 13;
/// Channels of the last layer: a multiple of four; the channels after the keypoints are not used.
inline constexpr int kMapChannels = 12;

inline constexpr std::array<Layer, kLayerCount> kLayers{{
    {.in = 1, .out = 24, .kernel = 3, .stride = 2},                       // 0: to 64 a side
    {.in = 24, .out = 40, .kernel = 3, .stride = 2},                      // 1: to 32
    {.in = 40, .out = 40, .kernel = 3},                                   // 2: skip connection to layer 10
    {.in = 40, .out = 64, .kernel = 3, .stride = 2},                      // 3: to 16
    {.in = 64, .out = 64, .kernel = 3},                                   // 4: skip connection to layer 8
    {.in = 64, .out = 128, .kernel = 3, .stride = 2},                     // 5: to 8
    {.in = 128, .out = 128, .kernel = 3},                                 // 6
    {.in = 128, .out = 128, .kernel = 3},                                 // 7
    {.in = 128, .out = 64, .kernel = 1, .is_rectified = false},           // 8: at 8, added to 4 at 16
    {.in = 64, .out = 64, .kernel = 3},                                   // 9
    {.in = 64, .out = 40, .kernel = 1, .is_rectified = false},            // 10: at 16, added to 2 at 32
    {.in = 40, .out = 40, .kernel = 3},                                   // 11
    {.in = 40, .out = kMapChannels, .kernel = 1, .is_rectified = false},  // 12: the heatmaps
}};

inline constexpr std::size_t kMagicBytes = 16;
inline constexpr char kMagic[kMagicBytes + 1] = "vbar keypoints 2";
inline constexpr std::size_t kLayerWords = 8;
inline constexpr std::size_t kCalibrationOffset = kMagicBytes + 4 * 4 + kLayerCount * kLayerWords * 4;
/// Number of bytes before the first layer's weights.
inline constexpr std::size_t kHeaderBytes = kCalibrationOffset + 8 * sizeof(float);
inline constexpr std::size_t kChecksumBytes = 4;

/// Position in the file of a layer's weights, and of the checksum for layer kLayerCount.
constexpr std::size_t offset_of_layer(int layer) {
  std::size_t offset = kHeaderBytes;
  for (int l = 0; l < layer; ++l) offset += kLayers[static_cast<std::size_t>(l)].bytes();
  return offset;
}

inline constexpr std::size_t kFileBytes = offset_of_layer(kLayerCount) + kChecksumBytes;

// Bounds of the numbers in the network. It is bit-identical everywhere although NEON has no denormal numbers (those
// below 2^-126, which it reads and writes as 0), because none arises.
//
// - A weight or bias is 0 or at least kMinWeight = 2^-40 in size, which load() checks: it is a multiple of 2^-63,
//   because a single-precision number of that size has its last of 24 bits there or higher.
// - An input of a layer is 0 or more than kMinActivation = 2^-60 in size: a multiple of 2^-83. This is ensured by
//   the ReLU, the sum of a layer with its skip connection, and the standardisation of the crop.
// - A product is 0 or more than 2^-100 in size, a normal number; before it is rounded it is a multiple of
//   2^-(63 + 83) = 2^-146, but it has at least the size 2^-100, so rounded to 24 bits a multiple of 2^-123.
// - A sum of multiples of 2^-123 is one, and stays one when rounded: 0 or at least 2^-123 in size, a normal number.
//
// So neither flushing nor gradual underflow ever occurs. Large numbers are harmless as well: infinities and NaN arise
// alike on every target (only a NaN's sign and payload differ, and these are not visible: a ReLU maps a NaN to 0, and
// run() rejects heatmaps that are not finite).

inline constexpr float kMinWeight = 0x1p-40F;
inline constexpr float kGreatestWeight = 0x1p20F;  ///< every weight is below
inline constexpr float kMinActivation = 0x1p-60F;  ///< every activation is above, or 0
inline constexpr float kGreatestSample = 0x1p20F;  ///< largest size of a sample of the crop

}  // namespace vbar::fsw::pose
