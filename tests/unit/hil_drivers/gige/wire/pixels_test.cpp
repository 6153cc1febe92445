// Mono12Packed by hand: GigE Vision puts pixels ABCh and 123h into ABh 3Ch 12h.

#include "hil_drivers/gige/wire/pixels.h"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/hil_drivers/gige/wire/hex.h"

namespace vbar::gige::wire {
namespace {

using test::hex;
using Numbers = std::vector<std::uint16_t>;

TEST(Pixels, TwelveBitsInThreeHalvesOfAByte) {
  const Numbers dn{0xABC, 0x123, 0xFFF};
  const Bytes bytes = pack_pixels(PixelFormat::kMono12Packed, 12, dn);
  EXPECT_EQ(bytes, hex("ab 3c 12 ff 0f"));
  EXPECT_EQ(unpack_pixels(PixelFormat::kMono12Packed, 3, bytes), dn);
}

TEST(Pixels, SixteenBitsAreLeftAlignedAndLittleEndian) {
  EXPECT_EQ(pack_pixels(PixelFormat::kMono16, 12, Numbers{0xABC, 0x001}), hex("c0 ab 10 00"));
  EXPECT_EQ(pack_pixels(PixelFormat::kMono16, 10, Numbers{0x3FF}), hex("c0 ff"));
  EXPECT_EQ(unpack_pixels(PixelFormat::kMono16, 1, hex("c0 ab")), Numbers{0xABC0});
}

TEST(Pixels, EightBitsAreTheUpperOnes) {
  EXPECT_EQ(pack_pixels(PixelFormat::kMono8, 12, Numbers{0xABC}), hex("ab"));
  EXPECT_EQ(unpack_pixels(PixelFormat::kMono8, 1, hex("ab")), Numbers{0xAB});
}

TEST(Pixels, MissingBytesAreNamed) {
  EXPECT_THROW((void)unpack_pixels(PixelFormat::kMono12Packed, 3, hex("ab 3c 12 ff")), std::invalid_argument);
  EXPECT_THROW((void)unpack_pixels(PixelFormat::kMono16, 2, hex("ab 3c 12")), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::gige::wire
