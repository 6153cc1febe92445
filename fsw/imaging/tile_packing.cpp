#include "fsw/imaging/tile_packing.h"

namespace vbar::fsw::imaging {
namespace {

constexpr std::uint16_t kMax12Bits = 0xFFF;

constexpr std::uint8_t low_byte(unsigned value) {
  return static_cast<std::uint8_t>(value & 0xFFU);
}

bool fits(std::span<const std::uint16_t> pixels, unsigned maximum) {
  unsigned all = 0;  // the maximum is all ones, so that a larger pixel leaves a bit above it
  for (const std::uint16_t pixel : pixels) all |= pixel;
  return all <= maximum;
}

void pack8(std::span<const std::uint16_t> pixels, std::uint8_t* out) {
  for (const std::uint16_t pixel : pixels) *out++ = low_byte(pixel);
}

void pack12(std::span<const std::uint16_t> pixels, std::uint8_t* out) {
  const std::size_t pairs = pixels.size() / 2;
  const std::uint16_t* in = pixels.data();
  for (std::size_t k = 0; k < pairs; ++k, in += 2, out += 3) {
    const unsigned a = in[0];
    const unsigned b = in[1];
    out[0] = low_byte(a >> 4U);
    out[1] = low_byte(a << 4U | b >> 8U);
    out[2] = low_byte(b);
  }
  if (pixels.size() % 2 != 0) {
    const unsigned a = *in;
    out[0] = low_byte(a >> 4U);
    out[1] = low_byte(a << 4U);
  }
}

void unpack8(const std::uint8_t* in, std::span<std::uint16_t> pixels) {
  for (std::uint16_t& pixel : pixels) pixel = *in++;
}

void unpack12(const std::uint8_t* in, std::span<std::uint16_t> pixels) {
  const std::size_t pairs = pixels.size() / 2;
  std::uint16_t* out = pixels.data();
  for (std::size_t k = 0; k < pairs; ++k, in += 3, out += 2) {
    const unsigned middle = in[1];
    out[0] = static_cast<std::uint16_t>(static_cast<unsigned>(in[0]) << 4U | middle >> 4U);
    out[1] = static_cast<std::uint16_t>((middle & 0xFU) << 8U | in[2]);
  }
  if (pixels.size() % 2 != 0) {
    *out = static_cast<std::uint16_t>(static_cast<unsigned>(in[0]) << 4U | static_cast<unsigned>(in[1]) >> 4U);
  }
}

}  // namespace

std::size_t pack_pixels(std::span<const std::uint16_t> pixels, int bits, std::span<std::uint8_t> out) {
  const std::size_t size = packed_size(pixels.size(), bits);
  if (size == 0 || size > out.size() || !fits(pixels, bits == 8 ? 0xFFU : kMax12Bits)) return 0;
  if (bits == 8) {
    pack8(pixels, out.data());
  } else {
    pack12(pixels, out.data());
  }
  return size;
}

std::size_t unpack_pixels(std::span<const std::uint8_t> bytes, int bits, std::span<std::uint16_t> pixels) {
  const std::size_t size = packed_size(pixels.size(), bits);
  if (size == 0 || size > bytes.size()) return 0;
  if (bits == 8) {
    unpack8(bytes.data(), pixels);
  } else {
    unpack12(bytes.data(), pixels);
  }
  return size;
}

}  // namespace vbar::fsw::imaging
