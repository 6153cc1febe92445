#include "host_sim/twins/camera/image_tiles.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "fsw/vision/imaging/image.h"
#include "fsw/vision/imaging/image_assembly.h"
#include "host_sim/twins/packet_encoder.h"

namespace vbar::twins::camera {
namespace {

constexpr std::int16_t kMax = std::numeric_limits<std::int16_t>::max();

std::size_t pixels_in(const Region& region) {
  return static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height);
}

std::size_t pixels_of_tile_with(int bits) {
  return static_cast<std::size_t>(bits == 12 ? fsw::imaging::kTilePixels12 : fsw::imaging::kTilePixels8);
}

bool fits_message(int number) {
  return number >= 0 && number <= kMax;
}

}  // namespace

std::optional<int> number_of_tiles(const Region& region, int bits) {
  const bool is_good = (bits == 8 || bits == 12) && fits_message(region.x) && fits_message(region.y) &&
                       fits_message(region.width) && fits_message(region.height) && pixels_in(region) > 0;
  if (!is_good) return std::nullopt;
  const std::size_t pixels_of_tile = pixels_of_tile_with(bits);
  const std::size_t tiles = (pixels_in(region) + pixels_of_tile - 1) / pixels_of_tile;
  if (tiles > static_cast<std::size_t>(kMax)) return std::nullopt;
  return static_cast<int>(tiles);
}

std::vector<Packet> image_tiles(const ImageLabel& label, const Region& region, int bits,
                                std::span<const std::uint16_t> dn) {
  if (bits != 8 && bits != 12) throw std::invalid_argument("a pixel on the link has 8 or 12 bits");
  const std::size_t pixels = pixels_in(region);
  if (dn.size() != pixels) throw std::invalid_argument("the image is not of the region that is sent");
  const std::size_t pixels_of_tile = pixels_of_tile_with(bits);
  const std::optional<int> number = number_of_tiles(region, bits);
  if (!number) throw std::invalid_argument("the region has no pixels, or more than the tiles of an image can state");
  const auto tiles = static_cast<std::size_t>(*number);

  image_tile message{};
  message.image = image_number_on_link(label.number);
  message.tiles = static_cast<std::int16_t>(tiles);
  message.width = static_cast<std::int16_t>(region.width);
  message.height = static_cast<std::int16_t>(region.height);
  message.origin_x = static_cast<std::int16_t>(region.x);
  message.origin_y = static_cast<std::int16_t>(region.y);
  message.bits = static_cast<std::int8_t>(bits);
  message.exposure_s = static_cast<float>(label.exposure_s);
  const auto sent_before = static_cast<std::uint64_t>(label.number) * tiles;
  PacketEncoder encoder(label.spacecraft, label.unit, static_cast<std::uint16_t>(sent_before & 0x3FFFU));
  std::vector<Packet> packets;
  packets.reserve(tiles);
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    const std::size_t begin = tile * pixels_of_tile;
    const auto piece = dn.subspan(begin, std::min(pixels_of_tile, pixels - begin));
    message.tile = static_cast<std::int16_t>(tile);
    message.pixels = static_cast<std::int16_t>(piece.size());
    if (piece.size() < pixels_of_tile) std::fill(std::begin(message.data), std::end(message.data), std::uint8_t{0});
    if (fsw::imaging::pack_pixels(piece, bits, message.data) == 0)
      throw std::invalid_argument("a pixel of the image has more bits than the link carries");
    packets.push_back(*encoder.encode(label.time, message));  // its numbers are finite
  }
  return packets;
}

}  // namespace vbar::twins::camera
