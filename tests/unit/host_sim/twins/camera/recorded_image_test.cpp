// An image with its pixels as bytes and back, and bytes that are damaged.

#include <algorithm>
#include <random>
#include <stdexcept>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "host_sim/twins/camera/logged_image.h"

namespace vbar::twins::camera {
namespace {

constexpr Region kRegion{710, 200, 60, 40};

ImageHeader header(int bits, Region region = kRegion) {
  return {{{995'000'000LL * 1'000'000'000LL + 1}, 2'147'483'700LL, 1, 3, 0.125}, region, bits};
}

std::vector<std::uint16_t> noise(std::size_t pixels, int bits) {
  std::mt19937 random(5);
  std::vector<std::uint16_t> dn(pixels);
  for (std::uint16_t& value : dn) value = static_cast<std::uint16_t>(random() & ((1U << bits) - 1U));
  return dn;
}

/// "holds damaged JPEG-LS data: ..." or "is a damaged record".
std::string error_of(const std::vector<std::uint8_t>& bytes) {
  try {
    static_cast<void>(pixels_of_recorded_image(bytes));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no error";
}

TEST(RecordedImage, ComesBackInEveryBit) {
  for (const int bits : {8, 12}) {
    for (const Region region : {kRegion, Region{0, 0, 1, 1}, Region{3, 5, 1, 500}, Region{0, 0, 501, 1}}) {
      const auto pixels = static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height);
      std::vector<std::uint16_t> flat(pixels, 0), full(pixels, static_cast<std::uint16_t>((1 << bits) - 1));
      for (const auto& dn : {noise(pixels, bits), flat, full}) {
        const std::vector<std::uint8_t> bytes = recorded_image_of(header(bits, region), dn);
        EXPECT_EQ(pixels_of_recorded_image(bytes), dn) << bits << " bits, " << region.width << " x " << region.height;
        const auto read = header_of_recorded_image(bytes);
        ASSERT_TRUE(read);
        EXPECT_EQ(read->region, region);
        EXPECT_EQ(read->bits, bits);
        EXPECT_EQ(read->label.time, header(bits).label.time);
        EXPECT_EQ(read->label.number, 2'147'483'700LL);
        EXPECT_EQ(read->label.exposure_s, 0.125);
        EXPECT_EQ(read->key(), (ImageKey{1, 3, 52})) << "the link counts images modulo 2^31";
      }
    }
  }
}

TEST(RecordedImage, PixelsThatAreNotOfTheImageAreRejected) {
  std::vector<std::uint16_t> dn(2400, 4095);
  EXPECT_THROW(static_cast<void>(recorded_image_of(header(8), dn)), std::invalid_argument);
  dn.back() = 4096;
  EXPECT_THROW(static_cast<void>(recorded_image_of(header(12), dn)), std::invalid_argument);
  dn.pop_back();
  EXPECT_THROW(static_cast<void>(recorded_image_of(header(12), dn)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(recorded_image_of(header(10), dn)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(recorded_image_of(header(12, {0, 0, 0, 0}), {})), std::invalid_argument);
}

// Offsets of the encoded message (recorded_image.lcm): hash 0, spacecraft 8, unit 10, time 12, number 20, exposure 28,
// x 36, y 40, width 44, height 48, bits 52, coding 53, size 54, data 58.
TEST(RecordedImage, HeaderThatIsDamagedIsRejected) {
  const std::vector<std::uint8_t> good = recorded_image_of(header(12), noise(2400, 12));
  const auto changed = [&](std::size_t at, std::uint8_t value) {
    std::vector<std::uint8_t> bytes = good;
    bytes[at] = value;
    return bytes;
  };
  for (const auto& [at, value, what] : {std::tuple{std::size_t{0}, 0x12, "type"},
                                        {8, 0x01, "spacecraft above 255"},
                                        {10, 0xFF, "unit below zero"},
                                        {20, 0xFF, "number below zero"},
                                        {28, 0xBF, "exposure below zero"},
                                        {36, 0x80, "x below zero"},
                                        {45, 0x01, "width above 32767"},
                                        {52, 10, "bits"},
                                        {53, 2, "coding"},
                                        {54, 0x7F, "size"},
                                        {57, 0x00, "size"}}) {
    const std::vector<std::uint8_t> bytes = changed(at, static_cast<std::uint8_t>(value));
    EXPECT_FALSE(header_of_recorded_image(bytes)) << what;
    EXPECT_EQ(error_of(bytes), "is a damaged record") << what;
  }
  std::vector<std::uint8_t> longer = good;
  longer.push_back(0);
  EXPECT_FALSE(header_of_recorded_image(longer));
  for (std::size_t size = 0; size < 68; ++size)
    EXPECT_FALSE(header_of_recorded_image(std::span(good).first(size))) << size;
}

/// The image of `header` with the JPEG-LS data of another one.
std::vector<std::uint8_t> with_data_of(const ImageHeader& other, const ImageHeader& header) {
  constexpr std::size_t kDataAt = 58;
  const auto pixels = [](const ImageHeader& of) {
    return static_cast<std::size_t>(of.region.width) * static_cast<std::size_t>(of.region.height);
  };
  std::vector<std::uint8_t> bytes = recorded_image_of(header, noise(pixels(header), header.bits));
  const std::vector<std::uint8_t> data = recorded_image_of(other, noise(pixels(other), other.bits));
  bytes.resize(kDataAt);
  bytes.insert(bytes.end(), data.begin() + kDataAt, data.end());
  const auto size = static_cast<std::uint32_t>(data.size() - kDataAt);
  for (std::size_t k = 0; k < 4; ++k) bytes[54 + k] = static_cast<std::uint8_t>(size >> (24U - 8U * k));
  return bytes;
}

TEST(RecordedImage, DataOfAnotherImageAreRejected) {
  EXPECT_EQ(error_of(with_data_of(header(12, {0, 0, 40, 60}), header(12))),
            "holds damaged JPEG-LS data: they are 40 x 60 pixels, the record states 60 x 40");
  EXPECT_EQ(error_of(with_data_of(header(8), header(12))),
            "holds damaged JPEG-LS data: they have 8 bits a pixel, the record states 12");
  EXPECT_EQ(error_of(with_data_of(header(12), header(12))), "no error");
}

// Whatever is damaged: an error, or pixels of the right number and bits (the checksum of the tiles finds those).
TEST(RecordedImage, DamagedDataAreAnErrorOrPixels) {
  const std::vector<std::uint8_t> good = recorded_image_of(header(12), noise(2400, 12));
  std::mt19937 random(7);
  int errors = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::vector<std::uint8_t> bytes = good;
    bytes[58 + random() % (bytes.size() - 58)] = static_cast<std::uint8_t>(random());
    try {
      const std::vector<std::uint16_t> dn = pixels_of_recorded_image(bytes);
      EXPECT_EQ(dn.size(), 2400U);
      EXPECT_TRUE(std::ranges::all_of(dn, [](std::uint16_t value) { return value < 4096; }));
    } catch (const std::runtime_error&) {
      ++errors;
    }
  }
  EXPECT_GT(errors, 0);
  // Cut anywhere, with a size that says so.
  for (std::size_t size = 58; size < good.size(); size += 97) {
    std::vector<std::uint8_t> bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size));
    for (std::size_t k = 0; k < 4; ++k) bytes[54 + k] = static_cast<std::uint8_t>((size - 58) >> (24U - 8U * k));
    EXPECT_EQ(error_of(bytes).rfind("holds damaged JPEG-LS data: ", 0), 0U) << size << ": " << error_of(bytes);
  }
}

}  // namespace
}  // namespace vbar::twins::camera
