// Check values of the catalogue of parametrised CRC algorithms (G. Cook, "CRC RevEng"): the checksum of "123456789".

#include "fsw/packets/crc.h"

#include <array>

#include <gtest/gtest.h>

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
