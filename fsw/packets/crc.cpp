#include "fsw/packets/crc.h"

#include <array>
#include <cstddef>

#include "fsw/core/crc32.h"

namespace vbar::fsw::packets {
namespace {

// Sixteen bytes at a time, by tables as in fsw/core/crc32.h; 8 KiB. Every byte of an image passes here on each link.
constexpr std::size_t kSlices = 16;

/// Entry [n][b]: the register after byte b and n bytes of zero, from a register of zero.
constexpr auto kCrc16Tables = [] {
  std::array<std::array<std::uint16_t, 256>, kSlices> tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t remainder = byte << 8U;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder & 0x8000U) != 0U ? (remainder << 1U) ^ 0x1021U : remainder << 1U;
    }
    tables[0][byte] = static_cast<std::uint16_t>(remainder & 0xFFFFU);
  }
  for (std::size_t n = 1; n < kSlices; ++n) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t before = tables[n - 1][byte];
      tables[n][byte] = static_cast<std::uint16_t>(((before << 8U) & 0xFFFFU) ^ tables[0][before >> 8U]);
    }
  }
  return tables;
}();

}  // namespace

std::uint16_t crc16_ccitt_false(std::span<const std::uint8_t> bytes) {
  const auto& t = kCrc16Tables;
  std::uint32_t crc = 0xFFFFU;
  while (bytes.size() >= kSlices) {
    const std::uint32_t high = (crc >> 8U) ^ bytes[0];
    const std::uint32_t low = (crc & 0xFFU) ^ bytes[1];
    const std::uint32_t head = std::uint32_t{t[15][high]} ^ t[14][low];
    const std::uint32_t middle = std::uint32_t{t[13][bytes[2]]} ^ t[12][bytes[3]] ^ t[11][bytes[4]] ^ t[10][bytes[5]] ^
                                 t[9][bytes[6]] ^ t[8][bytes[7]];
    const std::uint32_t rest = std::uint32_t{t[7][bytes[8]]} ^ t[6][bytes[9]] ^ t[5][bytes[10]] ^ t[4][bytes[11]] ^
                               t[3][bytes[12]] ^ t[2][bytes[13]] ^ t[1][bytes[14]] ^ t[0][bytes[15]];
    crc = head ^ (middle ^ rest);
    bytes = bytes.subspan(kSlices);
  }
  for (const std::uint8_t byte : bytes) crc = ((crc << 8U) & 0xFFFFU) ^ t[0][(crc >> 8U) ^ byte];
  return static_cast<std::uint16_t>(crc);
}

std::uint32_t crc32_ieee(std::span<const std::uint8_t> bytes) {
  return crc32_after(0xFFFFFFFFU, bytes) ^ 0xFFFFFFFFU;
}

}  // namespace vbar::fsw::packets
