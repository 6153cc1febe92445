#pragma once
// Big-endian integers in byte buffers, whatever the processor's own order and alignment rules are. The caller has
// checked that the bytes exist.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

namespace vbar::fsw::packets {

/// Reads sizeof(Integer) bytes from `offset` on.
template <std::unsigned_integral Integer>
[[nodiscard]] constexpr Integer read_big_endian(std::span<const std::uint8_t> bytes, std::size_t offset) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(Integer); ++i) value = (value << 8U) | bytes[offset + i];
  return static_cast<Integer>(value);
}

/// Writes sizeof(Integer) bytes from `offset` on.
template <std::unsigned_integral Integer>
constexpr void write_big_endian(Integer value, std::span<std::uint8_t> bytes, std::size_t offset) {
  std::uint64_t rest = value;
  for (std::size_t i = sizeof(Integer); i > 0; --i) {
    bytes[offset + i - 1] = static_cast<std::uint8_t>(rest & 0xFFU);
    rest >>= 8U;
  }
}

}  // namespace vbar::fsw::packets
