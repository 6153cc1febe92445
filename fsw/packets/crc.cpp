#include "fsw/packets/crc.h"

#include <array>
#include <cstddef>

#include "fsw/core/crc32.h"

namespace vbar::fsw::packets {
namespace {

// Eight bytes at a time, as in fsw/core/crc32.h; 4 KiB.
constexpr std::size_t kSlices = 8;

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
    const std::uint32_t head = std::uint32_t{t[7][high]} ^ t[6][low];
    const std::uint32_t rest = std::uint32_t{t[5][bytes[2]]} ^ t[4][bytes[3]] ^ t[3][bytes[4]] ^ t[2][bytes[5]] ^
                               t[1][bytes[6]] ^ t[0][bytes[7]];
    crc = head ^ rest;
    bytes = bytes.subspan(kSlices);
  }
  for (const std::uint8_t byte : bytes) crc = ((crc << 8U) & 0xFFFFU) ^ t[0][(crc >> 8U) ^ byte];
  return static_cast<std::uint16_t>(crc);
}

std::uint32_t crc32_ieee(std::span<const std::uint8_t> bytes) {
  return crc32_after(0xFFFFFFFFU, bytes) ^ 0xFFFFFFFFU;
}

}  // namespace vbar::fsw::packets
