#pragma once
// The keypoint network written down as its definition says: double precision, one loop an index, nothing shared with
// flight code but the table of layers.

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "fsw/vision/pose/architecture.h"
#include "fsw/vision/pose/keypoint_network.h"
#include "tests/unit/fsw/same_bits/digest.h"
#include "tests/unit/fsw/vision/pose/network_file.h"

namespace vbar::test {

/// [row][column][channel]
struct PlainMap {
  int side = 0;
  int channels = 0;
  std::vector<double> numbers;

  PlainMap(int side_cells, int channel_count)
      : side(side_cells),
        channels(channel_count),
        numbers(static_cast<std::size_t>(side_cells * side_cells * channel_count)) {}
  double& at(int row, int column, int channel) {
    return numbers[static_cast<std::size_t>((row * side + column) * channels + channel)];
  }
  [[nodiscard]] double beyond_edge_zero(int row, int column, int channel) const {
    if (row < 0 || column < 0 || row >= side || column >= side) return 0.0;
    return numbers[static_cast<std::size_t>((row * side + column) * channels + channel)];
  }
};

class PlainNetwork {
 public:
  explicit PlainNetwork(std::span<const std::byte> file) : file_(file) {}

  /// The maps, kMapChannels channels.
  PlainMap run(std::span<const float> crop) const {
    PlainMap input(fsw::pose::kInputSide, 1);
    for (std::size_t k = 0; k < crop.size(); ++k) input.numbers[k] = static_cast<double>(crop[k]);
    const PlainMap kept_32 = layer(2, layer(1, layer(0, input)));
    const PlainMap kept_16 = layer(4, layer(3, kept_32));
    const PlainMap deepest = layer(7, layer(6, layer(5, kept_16)));
    const PlainMap up_16 = layer(9, added(enlarged(layer(8, deepest)), kept_16));
    const PlainMap up_32 = layer(11, added(enlarged(layer(10, up_16)), kept_32));
    return layer(12, up_32);
  }

 private:
  /// A layer's weights and then its biases.
  [[nodiscard]] std::vector<double> numbers_of(int l) const {
    std::vector<float> stored(fsw::pose::kLayers[static_cast<std::size_t>(l)].bytes() / sizeof(float));
    std::memcpy(stored.data(), file_.data() + fsw::pose::offset_of_layer(l), stored.size() * sizeof(float));
    return {stored.begin(), stored.end()};
  }

  [[nodiscard]] PlainMap layer(int l, const PlainMap& in) const {
    const fsw::pose::Layer& shape = fsw::pose::kLayers[static_cast<std::size_t>(l)];
    const std::vector<double> numbers = numbers_of(l);
    const double* const biases = numbers.data() + shape.weights();
    const int margin = shape.kernel == 3 ? 1 : 0;
    PlainMap out(in.side / shape.stride, shape.out);
    for (int row = 0; row < out.side; ++row) {
      for (int column = 0; column < out.side; ++column) {
        double* const sums = &out.at(row, column, 0);
        for (int channel = 0; channel < shape.out; ++channel) sums[channel] = biases[channel];
        const double* weight = numbers.data();
        for (int ky = 0; ky < shape.kernel; ++ky) {
          for (int kx = 0; kx < shape.kernel; ++kx) {
            for (int c = 0; c < shape.in; ++c) {
              const double x =
                  in.beyond_edge_zero(row * shape.stride + ky - margin, column * shape.stride + kx - margin, c);
              for (int channel = 0; channel < shape.out; ++channel) sums[channel] += *weight++ * x;
            }
          }
        }
        for (int channel = 0; channel < shape.out && shape.is_rectified; ++channel) {
          if (sums[channel] < 0.0) sums[channel] = 0.0;
        }
      }
    }
    return out;
  }

  static PlainMap enlarged(const PlainMap& in) {
    PlainMap out(2 * in.side, in.channels);
    for (int row = 0; row < out.side; ++row) {
      for (int column = 0; column < out.side; ++column) {
        for (int c = 0; c < in.channels; ++c) out.at(row, column, c) = in.beyond_edge_zero(row / 2, column / 2, c);
      }
    }
    return out;
  }

  static PlainMap added(PlainMap a, const PlainMap& b) {
    for (std::size_t k = 0; k < a.numbers.size(); ++k) a.numbers[k] += b.numbers[k];
    return a;
  }

  std::span<const std::byte> file_;
};

// Weights and a crop at the lower end of what there can be, from integers only: the same on every machine.

/// Most weights are nothing, so that small numbers are not lost in sums with larger ones. In a sum some are of the size
/// 1 and positive, so that numbers live on from layer to layer, and some of the smallest there can be.
inline WeightsFile tiny_file(std::uint64_t seed) {
  same_bits::Arguments arguments(seed);
  return file_of([&](const fsw::pose::Layer& layer, std::size_t k) {
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
