// The frame strip, drawn on a display of the camera's own pixels and read back.

#include "hil_drivers/optical_stimulator/strip/frame_strip.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "hil_drivers/optical_stimulator/strip/strip_reader.h"

namespace vbar::optical_stimulator {
namespace {

using fsw::Vector2;
using twins::camera::Region;

constexpr double kFull = 2.4e6, kWhite = 12000.0, kGain = 0.125, kOffset = 64.0;
constexpr int kWidth = 540, kHeight = 80;

/// Display pixel (x, y) illuminates the detector's (x + 690, y + 140).
class Strip {
 public:
  Strip() : light_({2.2, 3.0, 1e5}, kWidth, kHeight, std::vector<float>(kWidth * kHeight, static_cast<float>(kFull))) {
    strip_.emplace(
        region_with_strip({710, 200, 500, 20}), light_,
        [](const Vector2& pixel) { return Vector2(pixel.x() + 690.0, pixel.y() + 140.0); },
        Region{0, 0, kWidth, kHeight}, kWhite);
  }

  [[nodiscard]] std::vector<std::uint16_t> image(std::uint16_t frame, double brightness = 1.0) const {
    Picture picture(kWidth, kHeight);
    strip_->draw(frame, picture);
    std::vector<std::uint16_t> dn;
    for (int y = 152; y < 220; ++y)
      for (int x = 710; x < 1210; ++x)
        dn.push_back(static_cast<std::uint16_t>(kOffset + kGain * brightness * kFull *
                                                              light_.fraction(picture.at(x - 690, y - 140))));
    return dn;
  }
  [[nodiscard]] const FrameStrip& strip() const { return *strip_; }

 private:
  DisplayLight light_;
  std::optional<FrameStrip> strip_;
};

TEST(FrameStrip, EveryNumberIsReadBack) {
  const Strip strip;
  EXPECT_NEAR(strip.strip().white_electrons(), kWhite, 0.1 * kWhite);
  for (unsigned frame = 0; frame < 65536; frame += 257) {
    const StripReading reading = read_strip(strip.image(static_cast<std::uint16_t>(frame)), 500, 300.0);
    ASSERT_EQ(reading.status, StripStatus::kRead) << frame;
    EXPECT_EQ(reading.frame, frame);
    EXPECT_NEAR((reading.white_dn - reading.black_dn) / kGain, strip.strip().white_electrons(), 10.0);
  }
}

TEST(FrameStrip, BrightnessIsMeasured) {
  const Strip strip;
  const StripReading reading = read_strip(strip.image(77, 0.9), 500, 300.0);
  EXPECT_NEAR((reading.white_dn - reading.black_dn) / kGain / strip.strip().white_electrons(), 0.9, 2e-3);
}

TEST(FrameStrip, OrientationAndCoverAreSeen) {
  const Strip strip;
  auto image = strip.image(1234);
  auto mirrored = image;
  for (std::size_t row = 0; row < mirrored.size() / 500; ++row)
    std::ranges::reverse(mirrored.begin() + static_cast<std::ptrdiff_t>(500 * row),
                         mirrored.begin() + static_cast<std::ptrdiff_t>(500 * (row + 1)));
  EXPECT_EQ(read_strip(mirrored, 500, 300.0).status, StripStatus::kMirrored);
  auto rotated = image;
  std::ranges::reverse(rotated);
  EXPECT_EQ(read_strip(rotated, 500, 300.0).status, StripStatus::kNone);
  auto covered = image;  // its right half
  for (std::size_t place = 0; place < covered.size(); ++place)
    if (place % 500 > 250) covered[place] = 64;
  EXPECT_EQ(read_strip(covered, 500, 300.0).status, StripStatus::kDamaged);
  EXPECT_EQ(read_strip(std::vector<std::uint16_t>(500 * 48, 64), 500, 300.0).status, StripStatus::kNone);
  EXPECT_THROW(static_cast<void>(read_strip(std::vector<std::uint16_t>(500 * 47), 500, 300.0)), std::invalid_argument);
}

// A check of 4 bits: one wrong cell is always found.
TEST(FrameStrip, OneWrongCellIsFound) {
  for (unsigned frame = 0; frame < 65536; frame += 101) {
    const Cells cells = cells_of(static_cast<std::uint16_t>(frame));
    for (int bit = 0; bit < kNumberBits; ++bit) {
      const Cells other = cells_of(static_cast<std::uint16_t>(frame ^ (1U << bit)));
      int different = 0;
      for (std::size_t k = 0; k < cells.size(); ++k) different += cells[k] != other[k] ? 1 : 0;
      EXPECT_GE(different, 2);
    }
  }
}

TEST(FrameStrip, NeedsRowsAndColumns) {
  EXPECT_EQ(region_with_strip({710, 200, 500, 800}), (Region{710, 152, 500, 848}));
  EXPECT_THROW(static_cast<void>(region_with_strip({710, 47, 500, 800})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(region_with_strip({710, 200, 479, 800})), std::invalid_argument);
  const DisplayLight light({2.2, 3.0, 1e5}, 100, 80, std::vector<float>(8000, 1e6F));
  EXPECT_THROW(
      FrameStrip(
          Region{710, 152, 500, 848}, light,
          [](const Vector2& pixel) { return Vector2(pixel + Vector2(690.0, 140.0)); }, Region{0, 0, 100, 80}, kWhite),
      std::runtime_error);
}

}  // namespace
}  // namespace vbar::optical_stimulator
