#include "fsw/packets/crc.h"

#include <array>
#include <cstddef>

namespace vbar::fsw::packets {
namespace {

constexpr std::array<std::uint16_t, 256> make_crc16_table() {
  std::array<std::uint16_t, 256> table{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t remainder = byte << 8U;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder & 0x8000U) != 0U ? (remainder << 1U) ^ 0x1021U : remainder << 1U;
    }
    table[byte] = static_cast<std::uint16_t>(remainder & 0xFFFFU);
  }
  return table;
}

constexpr std::array<std::uint32_t, 256> make_crc32_table() {
  constexpr std::uint32_t kReflectedPolynomial = 0xEDB88320U;
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder & 1U) != 0U ? (remainder >> 1U) ^ kReflectedPolynomial : remainder >> 1U;
    }
    table[byte] = remainder;
  }
  return table;
}

constexpr auto kCrc16Table = make_crc16_table();
constexpr auto kCrc32Table = make_crc32_table();

}  // namespace

std::uint16_t crc16_ccitt_false(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xFFFFU;
  for (const std::uint8_t byte : bytes) {
    crc = ((crc << 8U) & 0xFFFFU) ^ kCrc16Table[(crc >> 8U) ^ byte];
  }
  return static_cast<std::uint16_t>(crc);
}

std::uint32_t crc32_ieee(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::uint8_t byte : bytes) {
    crc = (crc >> 8U) ^ kCrc32Table[(crc ^ byte) & 0xFFU];
  }
  return crc ^ 0xFFFFFFFFU;
}

}  // namespace vbar::fsw::packets
