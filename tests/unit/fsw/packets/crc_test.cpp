// Check values of the catalogue of parametrised CRC algorithms (G. Cook, "CRC RevEng"): the checksum of "123456789".
// And the definition: the remainder of a division of polynomials, one bit at a time.

#include "fsw/packets/crc.h"

#include <array>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/core/crc32.h"

namespace vbar::fsw::packets {
namespace {

constexpr std::array<std::uint8_t, 9> kCheckInput{'1', '2', '3', '4', '5', '6', '7', '8', '9'};

TEST(Crc, Crc16CcittFalseHasItsCatalogueCheckValue) {
  EXPECT_EQ(crc16_ccitt_false(kCheckInput), 0x29B1);  // CRC-16/IBM-3740, also known as CCITT-FALSE
}

TEST(Crc, Crc32HasItsCatalogueCheckValue) {
  EXPECT_EQ(crc32_ieee(kCheckInput), 0xCBF43926U);  // CRC-32/ISO-HDLC
}

TEST(Crc, NothingHasTheStartValue) {
  EXPECT_EQ(crc16_ccitt_false({}), 0xFFFF);
  EXPECT_EQ(crc32_ieee({}), 0U);  // start and final XOR cancel
}

std::uint16_t crc16_by_bits(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xFFFF;
  for (const std::uint8_t byte : bytes)
    for (int bit = 7; bit >= 0; --bit) {
      const bool divides = (crc >> 15U & 1U) != (static_cast<std::uint32_t>(byte) >> bit & 1U);
      crc = (crc << 1U ^ (divides ? 0x1021U : 0U)) & 0xFFFFU;
    }
  return static_cast<std::uint16_t>(crc);
}

std::uint32_t crc32_register_by_bits(std::uint32_t crc, std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes)
    for (int bit = 0; bit < 8; ++bit) {
      const bool divides = (crc & 1U) != (static_cast<std::uint32_t>(byte) >> bit & 1U);
      crc = crc >> 1U ^ (divides ? 0xEDB88320U : 0U);
    }
  return crc;
}

// All lengths up to several times the bytes that are taken at once, from every alignment.
TEST(Crc, EveryLengthAndAlignmentGivesTheRemainderOfTheDivision) {
  std::mt19937 random(1);
  std::array<std::uint8_t, 80> bytes{};
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random() & 0xFFU);
  for (std::size_t begin = 0; begin < 8; ++begin)
    for (std::size_t size = 0; begin + size <= bytes.size(); ++size) {
      const auto piece = std::span(bytes).subspan(begin, size);
      ASSERT_EQ(crc16_ccitt_false(piece), crc16_by_bits(piece)) << size << " bytes from " << begin;
      ASSERT_EQ(crc32_ieee(piece), ~crc32_register_by_bits(0xFFFFFFFFU, piece)) << size << " bytes from " << begin;
      ASSERT_EQ(crc32_after(0, piece), crc32_register_by_bits(0, piece)) << size << " bytes from " << begin;
    }
}

// A polynomial with more than one term divides no single-bit error: every flipped bit must show.
TEST(Crc, EveryFlippedBitChangesBothChecksums) {
  std::array<std::uint8_t, 64> bytes{};
  const std::uint16_t crc16 = crc16_ccitt_false(bytes);
  const std::uint32_t crc32 = crc32_ieee(bytes);
  for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
    const auto mask = static_cast<std::uint8_t>(1U << (bit % 8));
    bytes[bit / 8] ^= mask;
    EXPECT_NE(crc16_ccitt_false(bytes), crc16) << "bit " << bit;
    EXPECT_NE(crc32_ieee(bytes), crc32) << "bit " << bit;
    bytes[bit / 8] ^= mask;
  }
}

}  // namespace
}  // namespace vbar::fsw::packets
