#pragma once
// CRC-32 of frames, files and messages of GNSS receivers: polynomial 0x04C11DB7 in its reflected form. These formats
// differ in the initial value of the register, and in whether the result is inverted.
//
// Eight bytes are processed at a time, by eight tables, 8 KiB in all (M. E. Kounavis, F. L. Berry, IEEE Trans.
// Computers 57, 2008): the remainders of the bytes are independent look-ups, whereas one byte at a time waits for the
// one before it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace vbar::fsw {

inline constexpr std::size_t kCrc32Slices = 8;

/// Entry [n][b] is the register after byte b and n bytes of zero, from a register of zero.
inline constexpr auto kCrc32Tables = [] {
  constexpr std::uint32_t kReflectedPolynomial = 0xEDB88320U;
  std::array<std::array<std::uint32_t, 256>, kCrc32Slices> tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) remainder = (remainder >> 1U) ^ ((remainder & 1U) * kReflectedPolynomial);
    tables[0][byte] = remainder;
  }
  for (std::size_t n = 1; n < kCrc32Slices; ++n)
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t before = tables[n - 1][byte];
      tables[n][byte] = (before >> 8U) ^ tables[0][before & 0xFFU];
    }
  return tables;
}();

/// Returns the register after one more byte.
constexpr std::uint32_t crc32_after(std::uint32_t crc, std::uint8_t byte) {
  return (crc >> 8U) ^ kCrc32Tables[0][(crc ^ byte) & 0xFFU];
}

/// Returns the register after more bytes.
constexpr std::uint32_t crc32_after(std::uint32_t crc, std::span<const std::uint8_t> bytes) {
  const auto& t = kCrc32Tables;
  while (bytes.size() >= kCrc32Slices) {
    // By single bytes: a target need not allow unaligned access, and one that does merges them.
    const auto first = static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8U |
                       static_cast<std::uint32_t>(bytes[2]) << 16U | static_cast<std::uint32_t>(bytes[3]) << 24U;
    const std::uint32_t low = crc ^ first;
    crc = t[7][low & 0xFFU] ^ t[6][(low >> 8U) & 0xFFU] ^ t[5][(low >> 16U) & 0xFFU] ^ t[4][low >> 24U] ^
          t[3][bytes[4]] ^ t[2][bytes[5]] ^ t[1][bytes[6]] ^ t[0][bytes[7]];
    bytes = bytes.subspan(kCrc32Slices);
  }
  for (const std::uint8_t byte : bytes) crc = crc32_after(crc, byte);
  return crc;
}

}  // namespace vbar::fsw
