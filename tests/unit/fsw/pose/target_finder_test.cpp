// The target as a bright box of known place among stars, shadow, stray light and the Earth's limb.

#include "fsw/pose/target_finder.h"

#include <algorithm>
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/fsw/pose/close_images.h"

namespace vbar::fsw::pose {
namespace {

using test::CloseImage;
using test::LitBox;

class TargetFinderTest : public testing::Test {
 protected:
  Finding find(const std::vector<std::uint16_t>& pixels) {
    return finder->find(test::view_of(pixels, test::kCloseWidth, test::kCloseHeight), levels);
  }
  /// The region holds the box's corners, and is no larger than the square around them by a half.
  void expect_around(const LitBox& box) const {
    const double c = std::abs(std::cos(box.turn));
    const double s = std::abs(std::sin(box.turn));
    const double width = c * box.width + s * box.height;
    const double height = s * box.width + c * box.height;
    const CropRegion& region = finder->region();
    EXPECT_GE(region.side_px, std::max(width, height));
    EXPECT_LE(region.side_px, 1.3 * (std::max(width, height) + 32.0));
    // To one and a half block
    EXPECT_NEAR(region.centre_px.x(), box.x, 12.0);
    EXPECT_NEAR(region.centre_px.y(), box.y, 12.0);
  }

  DetectorLevels levels{64.0, test::kCloseNoiseDn, 4000};
  std::unique_ptr<TargetFinder> finder = std::make_unique<TargetFinder>();
};

TEST_F(TargetFinderTest, TheTargetAmongStarsAndHotPixels) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const double s = static_cast<double>(seed);
    const LitBox box{
        .x = 300.0 + 20.0 * s, .y = 250.0, .width = 90.0 + 30.0 * s, .height = 80.0 + 20.0 * s, .turn = 0.3 * s};
    EXPECT_EQ(find(CloseImage(seed).box(box).stars_and_hot_pixels().expose()), Finding::kTarget);
    expect_around(box);
  }
}

/// Half of it has no more than Earthshine: 0.4 % of the sunlit half.
TEST_F(TargetFinderTest, HalfInShadow) {
  const LitBox box{.bright_electrons = 60000.0, .shadow_electrons = 250.0};
  EXPECT_EQ(find(CloseImage(1).box(box).stars_and_hot_pixels().expose()), Finding::kTarget);
  expect_around(box);
}

TEST_F(TargetFinderTest, BesideTheEarthsLimb) {
  const LitBox box{.x = 500.0, .y = 130.0};
  EXPECT_EQ(find(CloseImage(1).box(box).limb(220.0, 100000.0).expose()), Finding::kTarget);
  expect_around(box);
}

TEST_F(TargetFinderTest, InStrayLight) {
  const LitBox box{.x = 250.0, .y = 260.0};
  EXPECT_EQ(find(CloseImage(1).box(box).even_light(6000.0).expose()), Finding::kTarget);
  expect_around(box);
  EXPECT_EQ(find(CloseImage(2).box(box).stray_light(8000.0).expose()), Finding::kTarget);
  expect_around(box);
}

TEST_F(TargetFinderTest, WithTilesMissing) {
  const LitBox box;
  auto pixels = CloseImage(1).box(box).expose();
  std::fill(pixels.begin() + 100 * imaging::kTilePixels12, pixels.begin() + 104 * imaging::kTilePixels12,
            imaging::kMissingPixel);
  std::fill(pixels.begin() + 250 * imaging::kTilePixels12, pixels.begin() + 270 * imaging::kTilePixels12,
            imaging::kMissingPixel);
  EXPECT_EQ(find(pixels), Finding::kTarget);
  expect_around(box);
}

TEST_F(TargetFinderTest, OnItsPlaceOfTheDetector) {
  const LitBox box;
  const auto pixels = CloseImage(1).box(box).expose();
  ASSERT_EQ(find(pixels), Finding::kTarget);
  const CropRegion here = finder->region();
  ASSERT_EQ(finder->find(test::view_of(pixels, test::kCloseWidth, test::kCloseHeight, 80, 50), levels),
            Finding::kTarget);
  EXPECT_EQ(finder->region().centre_px, here.centre_px + Vector2(80.0, 50.0));
}

TEST_F(TargetFinderTest, WhatIsNoTarget) {
  EXPECT_EQ(find(CloseImage(1).expose()), Finding::kDark);
  EXPECT_EQ(find(CloseImage(2).stars_and_hot_pixels().expose()), Finding::kDark);
  EXPECT_EQ(find(CloseImage(3).even_light(3000.0).expose()), Finding::kNothing);
  EXPECT_EQ(find(CloseImage(4).stray_light(20000.0).expose()), Finding::kNothing);
  EXPECT_EQ(find(CloseImage(5).limb(200.0, 100000.0).expose()), Finding::kNothing);
  EXPECT_EQ(find(CloseImage(6).even_light(128000.0).expose()), Finding::kBlinded);
  EXPECT_EQ(find(CloseImage(7).limb(350.0, 200000.0).expose()), Finding::kBlinded);
  EXPECT_EQ(find(std::vector<std::uint16_t>(400'000, imaging::kMissingPixel)), Finding::kDark);
  EXPECT_EQ(find(std::vector<std::uint16_t>(400'000, 64)), Finding::kDark);
  EXPECT_EQ(find(std::vector<std::uint16_t>(300'000, 64)), Finding::kNothing) << "not its frame";
}

/// Any image within the bounds, none beyond: every size's blocks have room.
TEST_F(TargetFinderTest, ImagesOfAllShapes) {
  const std::vector<std::uint16_t> pixels(imaging::kMaxPixels, 64);
  for (const int width : {1, 7, 8, 9, 97, 98, 632, 633, 4095, 4096}) {
    const int height = std::min(imaging::kMaxSide, static_cast<int>(imaging::kMaxPixels) / width);
    const std::vector<std::uint16_t> these(pixels.begin(), pixels.begin() + width * height);
    EXPECT_EQ(finder->find(test::view_of(these, width, height), levels), Finding::kDark) << width;
  }
}

}  // namespace
}  // namespace vbar::fsw::pose
