// The sums of wide registers are those of four lanes, bit by bit; what four lanes give is compared with the definition
// in keypoint_network_test.cpp, and with other targets in tests/unit/fsw/same_bits.

#include "fsw/network/convolution.h"

#include <cstring>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/fsw/network/network_file.h"

namespace {

using namespace vbar::fsw::network;

std::vector<Registers> wide_registers_of_this_computer() {
  std::vector<Registers> found;
  for (const Registers registers : {Registers::kEight, Registers::kSixteen})
    if (registers <= widest_registers()) found.push_back(registers);
  return found;
}

/// A map in memory that ends where the map does, so that a sanitizer sees what is read behind it.
struct OwnedMap {
  FeatureMap map;
  std::vector<float> numbers;

  OwnedMap(int side, int channels) : numbers(static_cast<std::size_t>((side + 2) * (side + 2) * channels)) {
    map = {.numbers = numbers.data(), .side = side, .channels = channels};
  }
  void fill(unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<float> sample;
    for (int row = 0; row < map.side; ++row)
      for (int k = 0; k < map.side * map.channels; ++k) map.cell(row, 0)[k] = sample(random);
  }
};

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

TEST(Convolution, WideRegistersGiveTheBitsOfFourLanes) {
  const std::vector<Registers> wide = wide_registers_of_this_computer();
  if (wide.empty()) GTEST_SKIP() << "this computer has registers of four numbers only";
  const vbar::test::WeightsFile file = vbar::test::random_file(3);
  const auto panel = std::make_unique<WeightPanel>();
  int side = kInputSide;
  for (int l = 0; l < kLayerCount; ++l) {
    const Layer& layer = kLayers[static_cast<std::size_t>(l)];
    const auto weights = std::span<const std::byte>(file).subspan(offset_of_layer(l), layer.bytes());
    OwnedMap in(side, layer.in);
    in.fill(static_cast<unsigned>(l));
    side /= layer.stride;
    const bool is_last = l == kLayerCount - 1;
    const auto convolved = [&](Registers registers) {
      if (is_last) {
        std::vector<std::array<float, kMapCells>> maps(kKeypoints);
        convolve_to_maps(layer, weights, in.map, maps, *panel, registers);
        const float* const first = maps[0].data();
        return std::vector<float>(first, first + kKeypoints * kMapCells);
      }
      OwnedMap out(layer.is_rectified ? side : 2 * side, layer.out);
      out.fill(77);
      if (layer.is_rectified)
        convolve_rectified(layer, weights, in.map, out.map, *panel, registers);
      else
        convolve_and_add_enlarged(layer, weights, in.map, out.map, *panel, registers);
      return out.numbers;
    };
    const std::vector<float> expected = convolved(Registers::kFour);
    for (const Registers registers : wide)
      EXPECT_TRUE(same_bits(convolved(registers), expected))
          << "layer " << l << ", registers of " << static_cast<int>(registers);
    if (!layer.is_rectified) side *= 2;
  }
}

}  // namespace
