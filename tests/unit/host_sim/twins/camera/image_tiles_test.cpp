// Tiles against the format that vbar.lcm states, unpacked here bit by bit.

#include "host_sim/twins/camera/image_tiles.h"

#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>

#include "fsw/packets/messages.h"

namespace vbar::twins::camera {
namespace {

const ImageLabel kLabel{{995'000'000'000'000'000LL}, 5, 1, 2};

std::vector<image_tile> decode(const std::vector<Packet>& packets, const ImageLabel& label) {
  std::vector<image_tile> tiles;
  for (std::size_t k = 0; k < packets.size(); ++k) {
    const auto view = fsw::packets::parse_packet(packets[k]);
    EXPECT_TRUE(view.ok());
    EXPECT_EQ(view.value().header.time, label.time);
    EXPECT_EQ(view.value().header.spacecraft, label.spacecraft);
    EXPECT_EQ(view.value().header.unit, label.unit);
    EXPECT_EQ(view.value().header.sequence_count,
              (static_cast<std::size_t>(label.number) * packets.size() + k) % 16384);
    const auto tile = fsw::packets::decode<image_tile>(view.value());
    EXPECT_TRUE(tile.ok());
    EXPECT_EQ(tile.value().image, label.number);
    EXPECT_EQ(tile.value().tile, static_cast<int>(k));
    EXPECT_EQ(tile.value().tiles, static_cast<int>(packets.size()));
    tiles.push_back(tile.value());
  }
  return tiles;
}

/// Pixel k of a stream of `bits` a pixel, the most significant bit first.
unsigned pixel_of(const std::uint8_t* data, std::size_t k, std::size_t bits) {
  unsigned value = 0;
  for (std::size_t bit = k * bits; bit < (k + 1) * bits; ++bit)
    value = value << 1U | (data[bit / 8] >> (7 - bit % 8) & 1U);
  return value;
}

std::vector<std::uint16_t> pattern(std::size_t pixels, unsigned most) {
  std::vector<std::uint16_t> dn(pixels);
  for (std::size_t k = 0; k < pixels; ++k) dn[k] = static_cast<std::uint16_t>((k * 2654435761U >> 7U) % (most + 1));
  return dn;
}

class ImageTiles : public testing::TestWithParam<Region> {};

TEST_P(ImageTiles, HoldEveryPixelInOrder) {
  const Region region = GetParam();
  const auto pixels = static_cast<std::size_t>(region.width * region.height);
  for (const int bits : {8, 12}) {
    const std::size_t pixels_of_tile = bits == 8 ? 1302 : 868;
    const std::vector<std::uint16_t> dn = pattern(pixels, (1U << static_cast<unsigned>(bits)) - 1);
    const std::vector<image_tile> tiles = decode(image_tiles(kLabel, region, bits, dn), kLabel);
    ASSERT_EQ(tiles.size(), (pixels + pixels_of_tile - 1) / pixels_of_tile);
    std::size_t next = 0;
    for (const image_tile& tile : tiles) {
      EXPECT_EQ(tile.width, region.width);
      EXPECT_EQ(tile.height, region.height);
      EXPECT_EQ(tile.origin_x, region.x);
      EXPECT_EQ(tile.origin_y, region.y);
      EXPECT_EQ(tile.bits, bits);
      ASSERT_EQ(static_cast<std::size_t>(tile.pixels), std::min(pixels_of_tile, pixels - next));
      for (std::size_t k = 0; k < static_cast<std::size_t>(tile.pixels); ++k, ++next)
        ASSERT_EQ(pixel_of(tile.data, k, static_cast<std::size_t>(bits)), dn[next]) << next;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Regions, ImageTiles,
                         testing::Values(Region{710, 200, 500, 800}, Region{0, 0, 868, 1}, Region{3, 4, 1303, 1},
                                         Region{1919, 1199, 1, 1}, Region{0, 0, 17, 51}));

TEST(ImageTilesOfARun, CountOnFromImageToImage) {
  const Region region{0, 0, 60, 60};
  const std::vector<std::uint16_t> dn = pattern(3600, 4095);
  ImageLabel label = kLabel;
  label.number = 4000;  // 5 tiles an image: past the 14 bits of a sequence count
  static_cast<void>(decode(image_tiles(label, region, 12, dn), label));
}

TEST(ImageTilesOfARun, WhatDoesNotFitIsRefused) {
  const std::vector<std::uint16_t> dn(100);
  EXPECT_THROW(image_tiles(kLabel, {0, 0, 10, 10}, 10, dn), std::invalid_argument);
  EXPECT_THROW(image_tiles(kLabel, {0, 0, 11, 10}, 12, dn), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::twins::camera
