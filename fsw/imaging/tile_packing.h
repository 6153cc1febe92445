#pragma once
// Encoding of pixels in the bytes of a tile (vbar.lcm, image_tile), for both ends of the link. 8 bits: one byte per
// pixel. 12 bits, big-endian: two pixels in three bytes; an odd last one fills its first byte and the upper half of its
// second, whose lower half is zero.

#include <cstddef>
#include <cstdint>
#include <span>

namespace vbar::fsw::imaging {

/// Returns the number of bytes for `pixels` pixels of 8 or 12 bits; 0 for any other number of bits.
constexpr std::size_t packed_size(std::size_t pixels, int bits) {
  if (bits == 8) return pixels;
  return bits == 12 ? (3 * pixels + 1) / 2 : 0;
}

/// Writes packed_size() bytes to the front of `out` and returns their number; 0, and nothing written, if `out` is too
/// small, `bits` neither 8 nor 12 or a pixel needs more than `bits`.
std::size_t pack_pixels(std::span<const std::uint16_t> pixels, int bits, std::span<std::uint8_t> out);

/// Fills `pixels` from the front of `bytes` and returns the number of bytes read; 0, and nothing written, if there are
/// too few or `bits` is neither 8 nor 12.
std::size_t unpack_pixels(std::span<const std::uint8_t> bytes, int bits, std::span<std::uint16_t> pixels);

}  // namespace vbar::fsw::imaging
