#include "fsw/guard/apparent_size.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace vbar::fsw::guard {
namespace {

constexpr int kWidth = 400;
constexpr int kHeight = 300;
constexpr GuardCamera kDarkLevelCamera{.focal_length_px = 6000.0, .dark_level_dn = 64.0, .noise_dn = 2.0};
constexpr double kSide = 0.7;  // m

/// A dark image with a bright rectangle.
std::vector<std::uint16_t> picture(int x0, int y0, int width, int height) {
  std::vector<std::uint16_t> pixels(static_cast<std::size_t>(kWidth * kHeight), 70);
  for (int y = y0; y < y0 + height; ++y) {
    for (int x = x0; x < x0 + width; ++x) pixels[static_cast<std::size_t>(y * kWidth + x)] = 1500;
  }
  return pixels;
}
imaging::ImageView view(const std::vector<std::uint16_t>& pixels) {
  return {.frame = {.width = kWidth, .height = kHeight}, .pixels = pixels};
}

/// The Sun at a phase angle: 0 behind the camera.
Illumination at_phase(double angle) {
  return {.line_of_sight = Vector3::UnitZ(), .to_sun = Vector3(std::sin(angle), 0.0, -std::cos(angle))};
}

// A square face of 0.7 m in full light, 60 px wide: by similar triangles f * 0.7 / 60, of which
// nine tenths count as bright.
TEST(ApparentSize, RangeOfASquareByThePinhole) {
  const auto pixels = picture(100, 90, 60, 60);
  const LitArea area = lit_area(view(pixels), kDarkLevelCamera);
  EXPECT_EQ(area.pixels, 3600);
  EXPECT_FALSE(area.is_cut);
  const auto range_m = range_from_size(area, kDarkLevelCamera, at_phase(0.0), kSide);
  ASSERT_TRUE(range_m.has_value());
  EXPECT_NEAR(*range_m, 6000.0 * 0.9 * 0.7 / 60.0, 1e-9);
}

// Less of a sphere's disk is lit at a larger phase: the same lit area is then nearer.
TEST(ApparentSize, ThePhaseReducesTheLitArea) {
  const LitArea area{.pixels = 3600, .is_cut = false};
  const double full = *range_from_size(area, kDarkLevelCamera, at_phase(0.0), kSide);
  const double half = *range_from_size(area, kDarkLevelCamera, at_phase(1.0), kSide);
  EXPECT_NEAR(full / half, std::sqrt(2.0 / (1.0 + std::cos(1.0))), 1e-9);
}

TEST(ApparentSize, NothingFromACrescentACutTargetOrAFewPixels) {
  EXPECT_FALSE(range_from_size({3600, false}, kDarkLevelCamera, at_phase(2.0), kSide).has_value());
  EXPECT_FALSE(range_from_size({3600, true}, kDarkLevelCamera, at_phase(0.0), kSide).has_value());
  EXPECT_FALSE(range_from_size({299, false}, kDarkLevelCamera, at_phase(0.0), kSide).has_value());
  EXPECT_FALSE(range_from_size({0, false}, kDarkLevelCamera, at_phase(0.0), kSide).has_value());
  const double nan = std::nan("");
  EXPECT_FALSE(
      range_from_size({3600, false}, kDarkLevelCamera, {Vector3::Constant(nan), Vector3::UnitX()}, kSide).has_value());
}

TEST(ApparentSize, ATargetAtTheRimIsCut) {
  EXPECT_TRUE(lit_area(view(picture(kWidth - 60, 100, 60, 60)), kDarkLevelCamera).is_cut);
  EXPECT_TRUE(lit_area(view(picture(100, 0, 60, 60)), kDarkLevelCamera).is_cut);
  EXPECT_FALSE(lit_area(view(picture(1, 1, 60, 60)), kDarkLevelCamera).is_cut);
}

TEST(ApparentSize, DimmerLightShowsTheSameArea) {
  auto pixels = picture(100, 90, 60, 60);
  for (std::uint16_t& pixel : pixels) pixel = pixel > 1000 ? 300 : pixel;
  EXPECT_EQ(lit_area(view(pixels), kDarkLevelCamera).pixels, 3600);
  for (std::uint16_t& pixel : pixels) pixel = pixel > 200 ? 150 : pixel;
  EXPECT_EQ(lit_area(view(pixels), kDarkLevelCamera).pixels, 0) << "hardly lit";
}

TEST(ApparentSize, AFewHotPixelsAreNotTheBrightestPart) {
  auto pixels = picture(100, 90, 60, 60);
  for (std::size_t k = 0; k < 50; ++k) pixels[37 * k + 11] = 4095;
  const int lit = lit_area(view(pixels), kDarkLevelCamera).pixels;
  EXPECT_GE(lit, 3600);
  EXPECT_LE(lit, 3650);
}

TEST(ApparentSize, MissingPixelsAreNotLight) {
  auto pixels = picture(100, 90, 60, 60);
  for (std::size_t k = 0; k < 5000; ++k) pixels[k] = imaging::kMissingPixel;
  EXPECT_EQ(lit_area(view(pixels), kDarkLevelCamera).pixels, 3600);
}

}  // namespace
}  // namespace vbar::fsw::guard
