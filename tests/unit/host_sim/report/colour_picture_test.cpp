// Colour pictures, decoded again by libpng.

#include "host_sim/report/colour_picture.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <png.h>

namespace vbar::report {
namespace {

constexpr Colour kBlack{0, 0, 0}, kRed{200, 0, 0}, kWhite{255, 255, 255};

TEST(ColourPicture, ComesBackAsItWasDrawn) {
  ColourPicture picture(5, 3);
  picture.set(4, 2, kRed);
  picture.set(0, 0, kWhite);
  picture.blend(0, 0, kRed, 0.25);
  picture.blend(1, 0, kRed, std::nan(""));
  picture.set(5, 0, kRed);  // outside, as the next
  picture.set(0, -1, kRed);
  const std::vector<std::uint8_t> png = picture.png();
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_memory(&image, png.data(), png.size()));
  ASSERT_EQ(image.width, 5U);
  ASSERT_EQ(image.height, 3U);
  image.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> rgb(PNG_IMAGE_SIZE(image));
  ASSERT_TRUE(png_image_finish_read(&image, nullptr, rgb.data(), 0, nullptr));
  const auto at = [&](std::size_t x, std::size_t y) {
    const std::size_t k = 3 * (5 * y + x);
    return Colour{rgb[k], rgb[k + 1], rgb[k + 2]};
  };
  EXPECT_EQ(at(4, 2), kRed);
  EXPECT_EQ(at(0, 0), (Colour{241, 191, 191})) << "a quarter of 200 and three of 255; three of 255";
  EXPECT_EQ(at(1, 0), kBlack);
}

TEST(ColourPicture, NeedsPixels) {
  EXPECT_THROW(ColourPicture(0, 4), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::report
