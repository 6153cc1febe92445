// Pictures of camera images, decoded again by libpng.

#include "host_sim/report/image_png.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <png.h>

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
  const CameraPicture picture{3, 2, 0, 0, dn};
  const Decoded decoded = decode(png_of(picture, kStretch, {}));
  ASSERT_EQ(decoded.width, 3);
  ASSERT_EQ(decoded.height, 2);
  const auto grey = [](double place) { return 255.0 * std::asinh(10.0 * place) / std::asinh(10.0); };
  const double expected[] = {0.0, 0.0, grey(0.1), grey(0.5), 255.0, 255.0};
  for (int k = 0; k < 6; ++k) {
    const Rgb pixel = decoded.at(k % 3, k / 3);
    EXPECT_NEAR(pixel.r, expected[k], 1.01) << "252 shades of 256, " << k;
    EXPECT_EQ(pixel.r, pixel.g);
    EXPECT_EQ(pixel.r, pixel.b);
  }
}

TEST(ImagePng, EnlargesAndShowsMissingPixels) {
  const std::vector<std::uint16_t> dn{100, 1100, 0xFFFF, 100};
  const Decoded decoded = decode(png_of({2, 2, 0, 0, dn}, kStretch, {}, 3));
  ASSERT_EQ(decoded.width, 6);
  EXPECT_EQ(decoded.at(2, 2), (Rgb{0, 0, 0}));
  EXPECT_EQ(decoded.at(3, 0), (Rgb{255, 255, 255}));
  EXPECT_EQ(decoded.at(5, 2), (Rgb{255, 255, 255}));
  const Rgb missing = decoded.at(0, 5);
  EXPECT_NE(missing.r, missing.g) << "a colour no pixel has";
}

TEST(ImagePng, MarksStandAboutWhatTheyMark) {
  const std::vector<std::uint16_t> dn(100 * 80, 100);
  const CameraPicture picture{100, 80, 700, 200, dn};
  const std::vector<ImageMark> marks{{MarkShape::kBox, 720.0, 220.0, 5.0},
                                     {MarkShape::kCircle, 750.0, 230.0, 8.0},
                                     {MarkShape::kTriangle, 780.0, 250.0, 6.0}};
  const Decoded decoded = decode(png_of(picture, kStretch, marks));
  const auto is = [&](int x, int y, char colour) {
    const Rgb p = decoded.at(x - 700, y - 200);
    if (colour == 'r') return p.r > 200 && p.g < 100 && p.b < 100;
    if (colour == 'g') return p.g > 180 && p.r < 100 && p.b < 100;
    if (colour == 'b') return p.b > 200 && p.r < 100;
    return p == Rgb{0, 0, 0};
  };
  for (const int d : {-5, -2, 0, 3, 5}) {
    EXPECT_TRUE(is(715, 220 + d, 'r') && is(725, 220 + d, 'r') && is(720 + d, 215, 'r') && is(720 + d, 225, 'r')) << d;
  }
  EXPECT_TRUE(is(720, 220, ' ')) << "what is marked stays to be seen";
  EXPECT_TRUE(is(758, 230, 'g') && is(742, 230, 'g') && is(750, 222, 'g') && is(750, 238, 'g'));
  EXPECT_TRUE(is(742, 222, ' ')) << "a circle has no corners";
  EXPECT_TRUE(is(780, 238, 'b')) << "the tip, twice the inner radius up";
  EXPECT_TRUE(is(780, 256, 'b')) << "the base";
}

TEST(ImagePng, MarksOverTheEdgeAndAtNoPlaceDoNoHarm) {
  const std::vector<std::uint16_t> dn(20 * 20, 100);
  const CameraPicture picture{20, 20, 0, 0, dn};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<ImageMark> marks{{MarkShape::kBox, 0.0, 0.0, 5.0},
                                     {MarkShape::kCircle, 1e30, 0.0, 5.0},
                                     {MarkShape::kCircle, nan, 3.0, 5.0},
                                     {MarkShape::kTriangle, 5.0, 3.0, std::numeric_limits<double>::infinity()}};
  const Decoded decoded = decode(png_of(picture, kStretch, marks));
  EXPECT_GT(decoded.at(5, 0).r, 200);
  EXPECT_EQ(decoded.at(15, 15), (Rgb{0, 0, 0}));
}

TEST(ImagePng, PictureWithoutItsPixelsIsRefused) {
  const std::vector<std::uint16_t> dn(10);
  EXPECT_THROW(static_cast<void>(png_of({0, 0, 0, 0, {}}, kStretch, {})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(png_of({3, 3, 0, 0, dn}, kStretch, {})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(png_of({5, 2, 0, 0, dn}, kStretch, {}, 0)), std::invalid_argument);
}

TEST(ImagePng, StretchLiesAboveTheNoiseAndReachesTheBrightest) {
  std::vector<std::uint16_t> dn(10000);
  for (std::size_t k = 0; k < dn.size(); ++k) dn[k] = static_cast<std::uint16_t>(60 + k % 9);  // 60 to 68
  dn[500] = 3000;
  dn[501] = 0xFFFF;
  const Stretch stretch = stretch_for({100, 100, 0, 0, dn});
  EXPECT_NEAR(stretch.black_dn, 70.0, 2.0);
  EXPECT_EQ(stretch.white_dn, 3000.0);
  const std::vector<std::uint16_t> none(4, 0xFFFF);
  EXPECT_GT(stretch_for({2, 2, 0, 0, none}).white_dn, 0.0);
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
}  // namespace vbar::report
