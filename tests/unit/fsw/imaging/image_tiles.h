#pragma once
// An image cut into tiles, byte by byte from the text of vbar.lcm and not by the code under test.

#include <algorithm>
#include <vector>

#include "fsw/imaging/image.h"
#include "fsw/packets/messages.h"

namespace vbar::fsw::imaging {

inline std::vector<image_tile> tiles_of(const std::vector<std::uint16_t>& pixels, const ImageFrame& frame,
                                        int image_number) {
  const std::size_t of_tile = frame.bits == 12 ? 868 : 1302;
  const std::size_t count = (pixels.size() + of_tile - 1) / of_tile;
  std::vector<image_tile> tiles;
  for (std::size_t k = 0; k < count; ++k) {
    image_tile tile{};
    tile.image = image_number;
    tile.tile = static_cast<std::int16_t>(k);
    tile.tiles = static_cast<std::int16_t>(count);
    tile.width = static_cast<std::int16_t>(frame.width);
    tile.height = static_cast<std::int16_t>(frame.height);
    tile.origin_x = static_cast<std::int16_t>(frame.origin_x);
    tile.origin_y = static_cast<std::int16_t>(frame.origin_y);
    tile.bits = static_cast<std::int8_t>(frame.bits);
    const std::size_t first = k * of_tile;
    const std::size_t number = std::min(of_tile, pixels.size() - first);
    tile.pixels = static_cast<std::int16_t>(number);
    // A string of digits of four bits each: three a pixel, or two
    std::vector<unsigned> digits;
    for (std::size_t i = first; i < first + number; ++i) {
      const unsigned p = pixels[i];
      if (frame.bits == 12) digits.push_back(p / 256);
      digits.push_back(p / 16 % 16);
      digits.push_back(p % 16);
    }
    if (digits.size() % 2 != 0) digits.push_back(0);
    for (std::size_t i = 0; i < digits.size() / 2; ++i) {
      tile.data[i] = static_cast<std::uint8_t>(digits[2 * i] * 16 + digits[2 * i + 1]);
    }
    tiles.push_back(tile);
  }
  return tiles;
}

}  // namespace vbar::fsw::imaging
