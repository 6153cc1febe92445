// Bytes written out by hand from the layout in vbar.lcm, and back.

#include "fsw/imaging/tile_packing.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/imaging/image.h"

namespace vbar::fsw::imaging {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Pixels = std::vector<std::uint16_t>;

Bytes packed(const Pixels& pixels, int bits) {
  Bytes out(packed_size(pixels.size(), bits));
  EXPECT_EQ(pack_pixels(pixels, bits, out), out.size());
  return out;
}

TEST(TilePacking, TwelveBitsAreBigEndianPairs) {
  EXPECT_EQ(packed({0xABC, 0x123}, 12), (Bytes{0xAB, 0xC1, 0x23}));
  EXPECT_EQ(packed({0xABC, 0x123, 0xFED}, 12), (Bytes{0xAB, 0xC1, 0x23, 0xFE, 0xD0}));
  EXPECT_EQ(packed({0xFFF}, 12), (Bytes{0xFF, 0xF0}));
}

TEST(TilePacking, EightBitsAreBytes) {
  EXPECT_EQ(packed({0, 1, 255}, 8), (Bytes{0, 1, 255}));
}

TEST(TilePacking, AFullTileFillsItsBytes) {
  EXPECT_EQ(packed_size(kTilePixels12, 12), 1302u);
  EXPECT_EQ(packed_size(kTilePixels8, 8), 1302u);
}

TEST(TilePacking, ComesBackAsItWas) {
  std::mt19937 random(1);
  for (const int bits : {8, 12}) {
    for (std::size_t size = 1; size < 40; ++size) {
      Pixels pixels(size);
      for (std::uint16_t& pixel : pixels) pixel = static_cast<std::uint16_t>(random() & ((1U << bits) - 1U));
      Pixels back(size);
      const Bytes bytes = packed(pixels, bits);
      EXPECT_EQ(unpack_pixels(bytes, bits, back), bytes.size());
      EXPECT_EQ(back, pixels);
    }
  }
}

TEST(TilePacking, RefusesWhatDoesNotFit) {
  Bytes out(3, 0x55);
  EXPECT_EQ(pack_pixels(Pixels{1, 2, 3}, 12, out), 0u);
  EXPECT_EQ(pack_pixels(Pixels{1, 2, 3, 4}, 8, out), 0u);
  EXPECT_EQ(pack_pixels(Pixels{0x1000}, 12, out), 0u);
  EXPECT_EQ(pack_pixels(Pixels{0x100}, 8, out), 0u);
  EXPECT_EQ(pack_pixels(Pixels{1}, 10, out), 0u);
  EXPECT_EQ(out, Bytes(3, 0x55));
  Pixels pixels(3, 7);
  EXPECT_EQ(unpack_pixels(Bytes(4), 12, pixels), 0u);
  EXPECT_EQ(unpack_pixels(Bytes(2), 8, pixels), 0u);
  EXPECT_EQ(unpack_pixels(Bytes(9), 16, pixels), 0u);
  EXPECT_EQ(pixels, Pixels(3, 7));
}

}  // namespace
}  // namespace vbar::fsw::imaging
