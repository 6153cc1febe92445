// Pictures of camera images, decoded again by libpng.

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <png.h>

#include "host_sim/report/plots/png.h"

namespace vbar::report {

namespace {

struct Rgb {
  int r, g, b;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

struct Decoded {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
  [[nodiscard]] Rgb at(int x, int y) const {
    const auto k = 3 * static_cast<std::size_t>(y * width + x);
    return {rgb[k], rgb[k + 1], rgb[k + 2]};
  }
};

Decoded decode(const std::vector<std::uint8_t>& png) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_memory(&image, png.data(), png.size())) << image.message;
  image.format = PNG_FORMAT_RGB;
  Decoded decoded{static_cast<int>(image.width), static_cast<int>(image.height), {}};
  decoded.rgb.resize(PNG_IMAGE_SIZE(image));
  EXPECT_TRUE(png_image_finish_read(&image, nullptr, decoded.rgb.data(), 0, nullptr)) << image.message;
  return decoded;
}

const Stretch kStretch{100.0, 1100.0, 10.0};

TEST(ImagePng, PixelsComeBackStretched) {
  const std::vector<std::uint16_t> dn{0, 100, 200, 600, 1100, 4095};
  const CameraPicture picture{3, 2, dn};
  const Decoded decoded = decode(png_of(picture, kStretch));
  ASSERT_EQ(decoded.width, 3);
  ASSERT_EQ(decoded.height, 2);
  const auto grey = [](double place) { return 255.0 * std::asinh(10.0 * place) / std::asinh(10.0); };
  const double expected[] = {0.0, 0.0, grey(0.1), grey(0.5), 255.0, 255.0};
  for (int k = 0; k < 6; ++k) {
    const Rgb pixel = decoded.at(k % 3, k / 3);
    EXPECT_NEAR(pixel.r, expected[k], 1.01) << "255 shades of 256, " << k;
    EXPECT_EQ(pixel.r, pixel.g);
    EXPECT_EQ(pixel.r, pixel.b);
  }
}

TEST(ImagePng, MissingPixelsAreViolet) {
  const std::vector<std::uint16_t> dn{100, 1100, 0xFFFF, 100};
  const Decoded decoded = decode(png_of({2, 2, dn}, kStretch));
  EXPECT_EQ(decoded.at(0, 1), (Rgb{60, 30, 70}));
  EXPECT_EQ(decoded.at(1, 0), (Rgb{255, 255, 255}));
  EXPECT_EQ(decoded.at(1, 1), (Rgb{0, 0, 0}));
}

TEST(ImagePng, PictureWithoutItsPixelsIsRefused) {
  const std::vector<std::uint16_t> dn(10);
  EXPECT_THROW(static_cast<void>(png_of({0, 0, {}}, kStretch)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(png_of({3, 3, dn}, kStretch)), std::invalid_argument);
}

TEST(ImagePng, StretchLiesAboveTheNoiseAndReachesTheBrightest) {
  std::vector<std::uint16_t> dn(10000);
  for (std::size_t k = 0; k < dn.size(); ++k) dn[k] = static_cast<std::uint16_t>(60 + k % 9);  // 60 to 68
  dn[500] = 3000;
  dn[501] = 0xFFFF;
  const Stretch stretch = stretch_for({100, 100, dn});
  EXPECT_NEAR(stretch.black_dn, 70.0, 2.0);
  EXPECT_EQ(stretch.white_dn, 3000.0);
  const std::vector<std::uint16_t> none(4, 0xFFFF);
  EXPECT_GT(stretch_for({2, 2, none}).white_dn, 0.0);
}

// RFC 4648, section 10.
TEST(ImagePng, DataUriIsBase64) {
  const auto uri = [](std::string_view text) {
    return png_data_uri({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  };
  EXPECT_EQ(uri(""), "data:image/png;base64,");
  EXPECT_EQ(uri("f"), "data:image/png;base64,Zg==");
  EXPECT_EQ(uri("fo"), "data:image/png;base64,Zm8=");
  EXPECT_EQ(uri("foobar"), "data:image/png;base64,Zm9vYmFy");
}

}  // namespace

// Colour pictures, decoded again by libpng.

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
