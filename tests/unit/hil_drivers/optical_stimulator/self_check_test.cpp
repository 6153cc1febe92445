// Figures of the self check: correction of the day, centroids, verdict. The check of a whole bench is in
// tests/integration/optical_stimulator.

#include "hil_drivers/optical_stimulator/imaging/self_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil_drivers/optical_stimulator/pictures/frame_strip.h"

namespace vbar::optical_stimulator {

namespace {

using fsw::Vector2;
using testing::HasSubstr;

const Vector2 kMiddle(959.5, 599.5);

std::vector<DotPair> moved_dots(const Vector2& shift, double rotation, double scale) {
  std::vector<DotPair> dots;
  for (int k = 0; k < 40; ++k) {
    const Vector2 by_map(100.0 + 43.0 * k, 80.0 + std::fmod(377.0 * k, 1000.0));
    const Vector2 a = by_map - kMiddle;
    const Vector2 turned(std::cos(rotation) * a.x() - std::sin(rotation) * a.y(),
                         std::sin(rotation) * a.x() + std::cos(rotation) * a.y());
    dots.push_back({by_map, kMiddle + scale * turned + shift});
  }
  return dots;
}

TEST(DayCorrection, IsThatOfTheDots) {
  const FittedDay day = fit_day(moved_dots({0.3, -0.7}, 2e-4, 1.00015), kMiddle);
  EXPECT_NEAR(day.correction.shift_px.x(), 0.3, 1e-10);
  EXPECT_NEAR(day.correction.shift_px.y(), -0.7, 1e-10);
  EXPECT_NEAR(day.correction.rotation_rad, 2e-4, 1e-12);
  EXPECT_NEAR(day.correction.scale, 1.00015, 1e-12);
  for (const double residual : day.residuals_px) EXPECT_LT(residual, 1e-9);
}

TEST(DayCorrection, NeedsTwoPlaces) {
  EXPECT_THROW(static_cast<void>(fit_day({}, kMiddle)), std::invalid_argument);
  const std::vector<DotPair> same(3, DotPair{{1.0, 2.0}, {1.0, 2.0}});
  EXPECT_THROW(static_cast<void>(fit_day(same, kMiddle)), std::invalid_argument);
}

std::vector<std::uint16_t> spot_at(const Vector2& at, double sigma) {
  std::vector<std::uint16_t> dn;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 60; ++x)
      dn.push_back(static_cast<std::uint16_t>(
          std::lround(64.0 + 2000.0 * std::exp(-0.5 * (Vector2(x, y) - at).squaredNorm() / (sigma * sigma)))));
  return dn;
}

TEST(WindowedCentroid, FindsTheMiddleOfASpot) {
  for (const double fraction : {0.0, 0.21, 0.5, 0.83}) {
    const Vector2 at(30.0 + fraction, 20.0 - 0.6 * fraction);
    const auto spot = windowed_centroid(spot_at(at, 1.0), 60, {31.5, 18.5}, 64.0, 1.2, 100.0);
    ASSERT_TRUE(spot.has_value());
    // Rounding to whole numbers, of 2000: a few 1e-4 px.
    EXPECT_LT((spot->centre - at).norm(), 2e-3) << fraction;
  }
}

TEST(WindowedCentroid, IsEmptyWithoutLightOrAtTheEdge) {
  const std::vector<std::uint16_t> black(2400, 64);
  EXPECT_FALSE(windowed_centroid(black, 60, {30.0, 20.0}, 64.0, 1.2, 100.0));
  EXPECT_FALSE(windowed_centroid(spot_at({3.0, 20.0}, 1.0), 60, {3.0, 20.0}, 64.0, 1.2, 100.0));
}

SelfCheckFigures good() {
  SelfCheckFigures figures;
  figures.dots = 40;
  figures.residual_arcsec = 1.0;
  figures.brightness = figures.noise = figures.offset = 1.0;
  return figures;
}

TEST(SelfCheck, AcceptsAGoodBench) {
  EXPECT_EQ(complaint_of(good()), "");
}

TEST(SelfCheck, NamesEachFigureThatFails) {
  const auto complaint = [](auto change) {
    SelfCheckFigures figures = good();
    change(figures);
    return complaint_of(figures);
  };
  EXPECT_THAT(complaint([](auto& f) { f.residual_arcsec = 3.4; }), HasSubstr("residual 3.4 arcsec"));
  EXPECT_THAT(complaint([](auto& f) { f.dots = 30; }), HasSubstr("30 of 40"));
  EXPECT_THAT(complaint([](auto& f) { f.correction.shift_px = {2.1, 0.0}; }), HasSubstr("moved by 2.10"));
  EXPECT_THAT(complaint([](auto& f) { f.correction.scale = 1.0003; }), HasSubstr("300 ppm"));
  EXPECT_THAT(complaint([](auto& f) { f.brightness = 0.9; }), HasSubstr("brightness 0.900"));
  EXPECT_THAT(complaint([](auto& f) { f.noise = 1.3; }), HasSubstr("noise 1.300"));
  EXPECT_THAT(complaint([](auto& f) { f.offset = 1.3; }), HasSubstr("offset 1.300"));
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(complaint([](auto& f) { f.residual_arcsec = kNan; }), "");
  EXPECT_NE(complaint([](auto& f) { f.correction.scale = kNan; }), "");
  EXPECT_NE(complaint([](auto& f) { f.brightness = kNan; }), "");
}

}  // namespace

// The frame strip, drawn on a display of the camera's own pixels and read back.

namespace {

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
