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

/// The places that have the colour.
std::vector<std::pair<int, int>> places(const ColourPicture& picture, const Colour& colour) {
  std::vector<std::pair<int, int>> found;
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x)
      if (picture.at(x, y) == colour) found.emplace_back(x, y);
  return found;
}

TEST(ColourPicture, ABoxHasFourSides) {
  ColourPicture picture(20, 20);
  picture.box(10.0, 8.0, 6.0, kRed);
  const auto found = places(picture, kRed);
  EXPECT_EQ(found.size(), 24U);
  for (const auto& [x, y] : found) EXPECT_EQ(std::max(std::abs(x - 10), std::abs(y - 8)), 3);
}

// On the curve of three sigma the normalised square is nine; a pixel's rounding moves it by up to 0.7 px.
TEST(ColourPicture, AnEllipseIsWhereItsCovarianceSays) {
  const double xx = 64.0, xy = -30.0, yy = 36.0;
  ColourPicture picture(101, 81);
  picture.ellipse(50.0, 40.0, {xx, xy, yy}, 3.0, kWhite);
  const auto found = places(picture, kWhite);
  EXPECT_GT(found.size(), 100U);
  for (const auto& [px, py] : found) {
    const double x = px - 50.0, y = py - 40.0;
    const double square = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / (xx * yy - xy * xy);
    EXPECT_NEAR(std::sqrt(square), 3.0, 0.35) << px << ' ' << py;  // the small axis has a sigma of 3.4 px
  }
}

TEST(ColourPicture, LeavesOutWhatIsNone) {
  ColourPicture picture(10, 10);
  picture.line(std::nan(""), 0.0, 5.0, 5.0, kRed);
  picture.line(-1e300, 0.0, 5.0, 5.0, kRed);
  picture.ellipse(5.0, 5.0, {1.0, 2.0, 1.0}, 3.0, kRed);
  picture.ellipse(5.0, 5.0, {std::nan(""), 0.0, 1.0}, 3.0, kRed);
  picture.blend(5, 5, kRed, std::nan(""));
  EXPECT_TRUE(places(picture, kRed).empty());
  EXPECT_THROW(ColourPicture(0, 4), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::report
