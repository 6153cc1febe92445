#pragma once
// Pixels as a GigE Vision camera sends them. Mono16 is little-endian, and a converter of fewer bits stands left-aligned
// in it (12 bits: FFF0h); Mono12Packed (GigE Vision) puts two pixels into three bytes: P0 11..4, P1 3..0 | P0 3..0,
// P1 11..4.

#include <cstdint>
#include <span>
#include <vector>

#include "hil_drivers/gige/wire/big_endian.h"

namespace vbar::gige::wire {

enum class PixelFormat : std::uint32_t {
  kMono8 = 0x01080001,
  kMono12Packed = 0x010C0006,
  kMono16 = 0x01100007,
};

[[nodiscard]] bool is_pixel_format(std::uint32_t number);
[[nodiscard]] const char* name_of(PixelFormat format);
[[nodiscard]] std::size_t image_bytes(PixelFormat format, std::size_t pixels);

/// Packs `dn`: right-aligned numbers of a converter of `bits`, 8 to 16.
[[nodiscard]] Bytes pack_pixels(PixelFormat format, int bits, std::span<const std::uint16_t> dn);
/// Returns the numbers as they stand in `bytes`, Mono16 with its padding. Throws std::invalid_argument if bytes are
/// missing.
[[nodiscard]] std::vector<std::uint16_t> unpack_pixels(PixelFormat format, std::size_t pixels, ByteSpan bytes);

}  // namespace vbar::gige::wire
