#include "hil_drivers/gige/wire/pixels.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>
#include <string>

namespace vbar::gige::wire {
namespace {

std::uint16_t with_bits(std::uint16_t dn, int bits, int wanted) {
  return static_cast<std::uint16_t>(bits >= wanted ? dn >> (bits - wanted) : dn << (wanted - bits));
}

Bytes pack_12(int bits, std::span<const std::uint16_t> dn) {
  Bytes bytes(image_bytes(PixelFormat::kMono12Packed, dn.size()));
  for (std::size_t k = 0; k < dn.size(); k += 2) {
    const std::uint16_t first = with_bits(dn[k], bits, 12);
    const std::uint16_t second = k + 1 < dn.size() ? with_bits(dn[k + 1], bits, 12) : std::uint16_t{0};
    std::uint8_t* const at = bytes.data() + k / 2 * 3;
    at[0] = static_cast<std::uint8_t>(first >> 4);
    at[1] = static_cast<std::uint8_t>((first & 0xF) | (second & 0xF) << 4);
    if (k + 1 < dn.size()) at[2] = static_cast<std::uint8_t>(second >> 4);
  }
  return bytes;
}

std::vector<std::uint16_t> unpack_12(std::size_t pixels, ByteSpan bytes) {
  std::vector<std::uint16_t> dn(pixels);
  for (std::size_t k = 0; k < pixels; k += 2) {
    const std::uint8_t* const at = bytes.data() + k / 2 * 3;
    dn[k] = static_cast<std::uint16_t>(at[0] << 4 | (at[1] & 0xF));
    if (k + 1 < pixels) dn[k + 1] = static_cast<std::uint16_t>(at[2] << 4 | at[1] >> 4);
  }
  return dn;
}

}  // namespace

bool is_pixel_format(std::uint32_t number) {
  switch (static_cast<PixelFormat>(number)) {
    case PixelFormat::kMono8:
    case PixelFormat::kMono12Packed:
    case PixelFormat::kMono16:
      return true;
  }
  return false;
}

const char* name_of(PixelFormat format) {
  switch (format) {
    case PixelFormat::kMono8:
      return "Mono8";
    case PixelFormat::kMono12Packed:
      return "Mono12Packed";
    case PixelFormat::kMono16:
      return "Mono16";
  }
  return "?";
}

std::size_t image_bytes(PixelFormat format, std::size_t pixels) {
  switch (format) {
    case PixelFormat::kMono8:
      return pixels;
    case PixelFormat::kMono12Packed:
      return (pixels * 3 + 1) / 2;
    case PixelFormat::kMono16:
      return pixels * 2;
  }
  return 0;
}

Bytes pack_pixels(PixelFormat format, int bits, std::span<const std::uint16_t> dn) {
  if (format == PixelFormat::kMono12Packed) return pack_12(bits, dn);
  Bytes bytes(image_bytes(format, dn.size()));
  if (format == PixelFormat::kMono8) {
    std::transform(dn.begin(), dn.end(), bytes.begin(),
                   [bits](std::uint16_t value) { return static_cast<std::uint8_t>(with_bits(value, bits, 8)); });
    return bytes;
  }
  for (std::size_t k = 0; k < dn.size(); ++k)
    boost::endian::store_little_u16(bytes.data() + 2 * k, with_bits(dn[k], bits, 16));
  return bytes;
}

std::vector<std::uint16_t> unpack_pixels(PixelFormat format, std::size_t pixels, ByteSpan bytes) {
  const std::size_t needed = image_bytes(format, pixels);
  if (bytes.size() < needed)
    throw std::invalid_argument(std::to_string(pixels) + " pixels of " + name_of(format) + " need " +
                                std::to_string(needed) + " bytes, there are " + std::to_string(bytes.size()));
  if (format == PixelFormat::kMono12Packed) return unpack_12(pixels, bytes);
  if (format == PixelFormat::kMono8) return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(pixels)};
  std::vector<std::uint16_t> dn(pixels);
  if (needed > 0) std::memcpy(dn.data(), bytes.data(), needed);
  if constexpr (std::endian::native == std::endian::big)
    for (std::uint16_t& value : dn) value = boost::endian::endian_reverse(value);
  return dn;
}

}  // namespace vbar::gige::wire
