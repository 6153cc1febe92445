#include "host_sim/star_images/grey_image.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "host_sim/star_images/star_fix.h"

namespace vbar::star_images {
namespace {

constexpr int kSide = 64;

std::string pgm(int largest, const std::string& pixels) {
  return "P5\n# a comment\n64 64\n" + std::to_string(largest) + "\n" + pixels;
}

std::string integer(unsigned value, int size, bool big_endian) {
  std::string bytes;
  for (int k = 0; k < size; ++k) bytes += static_cast<char>(value >> (8 * (big_endian ? size - 1 - k : k)) & 255U);
  return bytes;
}

/// TIFF 6.0 with two strips after the directory; fields: tag, type (3: 16 bits, 4: 32 bits), value.
struct TiffMaker {
  bool big_endian = false;
  unsigned compression = 1, samples = 1, bits = 16, photometric = 1, offset_shift = 0;

  [[nodiscard]] std::string bytes(const std::string& pixels) const {
    const auto u = [&](unsigned value, int size) { return integer(value, size, big_endian); };
    const auto field = [&](unsigned tag, unsigned type, unsigned count, unsigned value) {
      return u(tag, 2) + u(type, 2) + u(count, 4) + (type == 3 ? u(value, 2) + u(0, 2) : u(value, 4));
    };
    const unsigned strips_at = 8 + 2 + 12 * 8 + 4, pixels_at = strips_at + 8;
    const auto half = static_cast<unsigned>(pixels.size() / 2);
    return (big_endian ? "MM" : "II") + u(42, 2) + u(8, 4) + u(8, 2) + field(256, 3, 1, kSide) +
           field(257, 3, 1, kSide) + field(258, 3, 1, bits) + field(259, 3, 1, compression) +
           field(262, 3, 1, photometric) + field(273, 4, 2, strips_at) + field(277, 3, 1, samples) +
           field(278, 3, 1, kSide / 2) + u(0, 4) + u(pixels_at + offset_shift, 4) + u(pixels_at + half, 4) + pixels;
  }
};

TEST(GreyImage, Pgm8AndTiffInBothByteOrders) {
  std::string pixels(kSide * kSide, '\x07');
  pixels[kSide + 3] = '\xC8';
  const GreyImage image = grey_image_of(pgm(255, pixels), "a.pgm");
  EXPECT_EQ(image.bits, 8);
  EXPECT_EQ(image.pixels.at(kSide + 3), 200);
  for (const bool big_endian : {false, true}) {
    std::string wide;
    for (int k = 0; k < kSide * kSide; ++k) wide += integer(static_cast<unsigned>(k % 4096), 2, big_endian);
    const GreyImage tiff = grey_image_of(TiffMaker{.big_endian = big_endian}.bytes(wide), "a.tiff");
    EXPECT_EQ(tiff.bits, 12);
    ASSERT_EQ(tiff.pixels.size(), std::size_t{kSide} * kSide);
    for (int k = 0; k < kSide * kSide; ++k) ASSERT_EQ(tiff.pixels[static_cast<std::size_t>(k)], k % 4096);
  }
}

TEST(GreyImage, SixteenBitsAreDividedBySixteen) {
  std::string wide;
  for (int k = 0; k < kSide * kSide; ++k) wide += integer(static_cast<unsigned>(16 * k), 2, true);
  const GreyImage image = grey_image_of(pgm(65535, wide), "a.pgm");
  for (int k = 0; k < kSide * kSide; ++k) ASSERT_EQ(image.pixels[static_cast<std::size_t>(k)], k);
}

std::string refusal(const std::string& bytes) {
  try {
    static_cast<void>(grey_image_of(bytes, "image"));
  } catch (const ImageRefused& refused) {
    return refused.what();
  }
  return "accepted";
}

TEST(GreyImage, RefusalsNameWhatWasFoundAndWhatIsAccepted) {
  const std::string pixels(2 * kSide * kSide, '\1');
  EXPECT_EQ(refusal("GIF89a"),
            "image: found another format; accepted: PGM (P5), TIFF; ImageMagick converts: convert IMAGE image.pgm");
  EXPECT_EQ(refusal("P5 9 64 255 "), "image: found 9 x 64 pixels; accepted: 64 to 4096 a side");
  EXPECT_EQ(refusal("P5 64 64 99999 "), "image: found 99999 as largest value; accepted: 1 to 65535");
  EXPECT_EQ(refusal("P5 64 x"),
            "image: found no number for the height at byte 6; accepted: P5, width, height and largest value");
  EXPECT_EQ(refusal(pgm(255, "short")), "image: found 5 bytes of pixels; accepted: 4096 of this size");
  EXPECT_EQ(refusal(TiffMaker{.compression = 5}.bytes(pixels)), "image: found compression 5; accepted: 1 (none)");
  EXPECT_EQ(refusal(TiffMaker{.samples = 3}.bytes(pixels)), "image: found 3 values a pixel; accepted: 1 (grey)");
  EXPECT_EQ(refusal(TiffMaker{.bits = 4}.bytes(pixels)), "image: found 4 bits a pixel; accepted: 8, 16");
  EXPECT_EQ(refusal(TiffMaker{.photometric = 0}.bytes(pixels)),
            "image: found photometric interpretation 0; accepted: 1 (0 is black)");
  EXPECT_NE(refusal(TiffMaker{.offset_shift = 1U << 31U}.bytes(pixels)).find("a file that reaches byte"),
            std::string::npos);
}

TEST(GreyImage, AFolderCannotBeRead) {
  EXPECT_THROW(static_cast<void>(read_grey_image(".")), ImageRefused);
}

TEST(GreyImage, EveryTruncationIsRefused) {
  const std::string tiff = TiffMaker{}.bytes(std::string(2 * kSide * kSide, '\1'));
  const std::string map = pgm(255, std::string(kSide * kSide, '\1'));
  for (const std::string& whole : {tiff, map}) {
    ASSERT_EQ(refusal(whole), "accepted");
    for (std::size_t size = 0; size < whole.size(); size += size < 200 ? 1 : 97)
      ASSERT_NE(refusal(whole.substr(0, size)), "accepted") << size;
  }
}

TEST(DetectObjects, APointOnTheBorderOfTwoRegionsIsFoundOnce) {
  // 1024 x 768 pixels are four regions, whose borders are at 511.5 and 383.5.
  GreyImage image{.width = 1024, .height = 768, .bits = 12, .pixels = std::vector<std::uint16_t>(1024 * 768, 100)};
  unsigned state = 1;
  for (std::uint16_t& pixel : image.pixels) {
    state = state * 1664525U + 1013904223U;
    pixel = static_cast<std::uint16_t>(100U + (state >> 29U));
  }
  const auto add_point = [&](double x, double y) {
    for (int v = static_cast<int>(y) - 4; v <= static_cast<int>(y) + 5; ++v)
      for (int u = static_cast<int>(x) - 4; u <= static_cast<int>(x) + 5; ++u)
        image.pixels[static_cast<std::size_t>(v * 1024 + u)] =
            static_cast<std::uint16_t>(image.pixels[static_cast<std::size_t>(v * 1024 + u)] +
                                       2000.0 * std::exp(-((u - x) * (u - x) + (v - y) * (v - y)) / 2.0));
  };
  const std::vector<fsw::Vector2> places{{511.5, 200.0}, {700.0, 383.5}, {511.4, 383.6}, {100.0, 100.0}};
  for (const fsw::Vector2& place : places) add_point(place.x(), place.y());
  const ImageObjects found = detect_objects(image, {});
  ASSERT_EQ(found.objects.size(), places.size());
  for (const fsw::Vector2& place : places) {
    EXPECT_TRUE(std::ranges::any_of(found.objects, [&](const auto& object) {
      return (object.centroid_px - place).norm() < 0.05;
    })) << place.transpose();
  }
}

}  // namespace
}  // namespace vbar::star_images
