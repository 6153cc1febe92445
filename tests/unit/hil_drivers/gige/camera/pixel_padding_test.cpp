// Left-aligned numbers: FLIR, Grasshopper3 GigE technical reference 3.1: 12 bits are FFF0h.

#include "hil_drivers/gige/camera/pixel_padding.h"

#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace vbar::gige {
namespace {

/// All numbers of a converter, left-aligned.
std::vector<std::uint16_t> all_numbers(int bits) {
  std::vector<std::uint16_t> pixels(std::size_t{1} << bits);
  for (std::size_t k = 0; k < pixels.size(); ++k) pixels[k] = static_cast<std::uint16_t>(k << (16 - bits));
  return pixels;
}

TEST(PixelPadding, ConvertersOfEvenBitsAreFound) {
  for (const int bits : {8, 10, 12, 14, 16}) {
    PixelPadding padding(12);
    padding.observe(all_numbers(bits));
    EXPECT_EQ(padding.bits(), bits);
    EXPECT_EQ(padding.shift(), 16 - bits);
    EXPECT_TRUE(padding.is_decided());
  }
}

TEST(PixelPadding, EvenImageDecidesNothing) {
  PixelPadding padding(12);
  // The offset of 64, left-aligned, has ten zeros.
  padding.observe(std::vector<std::uint16_t>(1000, 64 << 4));
  EXPECT_FALSE(padding.is_decided());
  EXPECT_EQ(padding.shift(), 4);
  EXPECT_EQ(padding.bits(), 12);
}

TEST(PixelPadding, LaterImagesCorrectTheFirst) {
  PixelPadding padding(12);
  padding.observe(std::vector<std::uint16_t>(1000, 0));
  EXPECT_EQ(padding.shift(), 4);
  padding.observe(all_numbers(10));
  EXPECT_EQ(padding.bits(), 10);
  padding.observe(all_numbers(12));
  EXPECT_EQ(padding.bits(), 12);
}

TEST(PixelPadding, RightAlignedNumbersAreRecognised) {
  PixelPadding padding(12);
  std::vector<std::uint16_t> pixels(4096);
  std::iota(pixels.begin(), pixels.end(), std::uint16_t{0});
  padding.observe(pixels);
  EXPECT_EQ(padding.shift(), 0);
  EXPECT_EQ(padding.bits(), 12);
}

}  // namespace
}  // namespace vbar::gige
