#pragma once
// Weights files made for tests, and a crop for them.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <random>
#include <span>
#include <vector>

#include "fsw/packets/crc.h"
#include "fsw/vision/pose/architecture.h"

namespace vbar::test {

using WeightsFile = std::vector<std::byte>;
using Crop = std::array<float, fsw::pose::kInputSamples>;

template <class T>
void put(WeightsFile& file, std::size_t offset, T value) {
  std::memcpy(file.data() + offset, &value, sizeof value);
}

/// Makes the checksum right again after a change.
inline void seal(WeightsFile& file) {
  const std::size_t covered = file.size() - fsw::pose::kChecksumBytes;
  const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(file.data()), covered);
  put(file, covered, fsw::packets::crc32_ieee(bytes));
}

/// All weights 0.
inline WeightsFile blank_file() {
  using namespace fsw::pose;
  WeightsFile file(kFileBytes);
  std::memcpy(file.data(), kMagic, kMagicBytes);
  std::size_t offset = kMagicBytes;
  const auto word = [&](int value) {
    put(file, offset, static_cast<std::uint32_t>(value));
    offset += 4;
  };
  for (const int value : {kLayerCount, kInputSide, kMapSide, kKeypoints}) word(value);
  for (const Layer& l : kLayers) {
    for (const int value : {l.in, l.out, l.kernel, l.stride, l.is_rectified ? 1 : 0, 0, 0, 0}) word(value);
  }
  for (const float value : {1.25F, 0.0625F, 1.5F, 0.125F, 0.03125F}) {
    put(file, offset, value);
    offset += 4;
  }
  seal(file);
  return file;
}

/// Weight or bias number k of a layer, counted as the file has them.
inline std::size_t place_of_weight(int layer, std::size_t k) {
  return fsw::pose::offset_of_layer(layer) + sizeof(float) * k;
}

/// `number(layer, k)` for every weight k of a layer and, from layer.weights() on, every bias.
template <class Number>
WeightsFile file_of(Number&& number) {
  using namespace fsw::pose;
  WeightsFile file = blank_file();
  for (int l = 0; l < kLayerCount; ++l) {
    const Layer& layer = kLayers[static_cast<std::size_t>(l)];
    for (std::size_t k = 0; k < layer.weights() + static_cast<std::size_t>(layer.out); ++k) {
      put(file, place_of_weight(l, k), static_cast<float>(number(layer, k)));
    }
  }
  seal(file);
  return file;
}

/// Random weights such that numbers neither grow nor fade from layer to layer (He et al. 2015).
inline WeightsFile random_file(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return file_of([&](const fsw::pose::Layer& layer, std::size_t) {
    return normal(random) * std::sqrt(2.0 / (layer.kernel * layer.kernel * layer.in));
  });
}

/// Mean 0 and deviation 1, as crops are.
inline Crop random_crop(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> sample;
  Crop crop;
  for (float& s : crop) s = sample(random);
  return crop;
}

/// A bright quadrangle with a shadow across it before a dark sky.
inline Crop structured_crop() {
  Crop crop;
  for (int y = 0; y < fsw::pose::kInputSide; ++y) {
    for (int x = 0; x < fsw::pose::kInputSide; ++x) {
      const bool inside = x + y > 70 && x - y < 50 && y < 100 && x > 20;
      const bool shaded = x + 2 * y > 180 && x + 2 * y < 220;
      crop[static_cast<std::size_t>(y * fsw::pose::kInputSide + x)] = !inside ? -0.6F : shaded ? 0.1F : 1.5F;
    }
  }
  return crop;
}

}  // namespace vbar::test
