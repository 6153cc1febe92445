#include "hil_drivers/grand/wire/pps_datagram.h"

#include <gtest/gtest.h>

namespace vbar::grand::wire {
namespace {

// i64, i64, u32, little-endian, written out by hand.
constexpr std::array<std::uint8_t, 20> kBytes = {0x08, 0x07, 0x06, 0x05, 0x04, 0x03, 0x02, 0x01, 0x18, 0x17,
                                                 0x16, 0x15, 0x14, 0x13, 0x12, 0x11, 0xEF, 0xBE, 0xAD, 0xDE};
constexpr PpsDatagram kDatagram{{0x0102030405060708}, 0x1112131415161718, 0xDEADBEEF};

TEST(PpsDatagram, HasTheLayoutOfTheTable) {
  EXPECT_EQ(encode_pps_datagram(kDatagram), kBytes);
  EXPECT_EQ(decode_pps_datagram(kBytes), kDatagram);
}

TEST(PpsDatagram, OtherLengthsAreRefused) {
  std::vector<std::uint8_t> bytes(kBytes.begin(), kBytes.end());
  bytes.push_back(0);
  EXPECT_FALSE(decode_pps_datagram(bytes));
  for (bytes.resize(19);; bytes.pop_back()) {
    EXPECT_FALSE(decode_pps_datagram(bytes));
    if (bytes.empty()) break;
  }
}

TEST(PpsDatagram, TimesOutsideTheLimitsAreRefused) {
  for (const std::size_t last_byte : {7U, 15U})
    for (const std::uint8_t value : {std::uint8_t{0x40}, std::uint8_t{0x80}, std::uint8_t{0xFF}}) {
      auto bytes = kBytes;
      bytes[last_byte] = value;
      EXPECT_FALSE(decode_pps_datagram(bytes));
    }
  auto largest = kBytes;
  for (const std::size_t first : {0U, 8U}) {
    std::fill_n(largest.begin() + static_cast<std::ptrdiff_t>(first), 7, std::uint8_t{0xFF});
    largest[first + 7] = 0x3F;
  }
  ASSERT_TRUE(decode_pps_datagram(largest));
  EXPECT_EQ(decode_pps_datagram(largest)->gps.ns, kPpsTimeLimit_ns - 1);
}

}  // namespace
}  // namespace vbar::grand::wire
