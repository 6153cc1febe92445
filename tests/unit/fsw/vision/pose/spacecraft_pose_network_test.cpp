// Images without a target, or of which nothing can be made: a status for each and never a pose.

#include "fsw/vision/pose/spacecraft_pose_network.h"

#include <algorithm>
#include <memory>

#include <gtest/gtest.h>

#include "fsw/vision/pose/target_finder.h"
#include "tests/support/tango_view.h"
#include "tests/unit/fsw/vision/pose/close_images.h"

namespace vbar::fsw::pose {

namespace {

using test::CloseImage;

class PoseNetworkTest : public testing::Test {
 protected:
  PoseNetworkTest() {
    PoseCameraSettings settings;
    settings.frame = {test::kCloseWidth, test::kCloseHeight, 80, 50, 12};
    settings.model = test::close_camera();
    settings.noise_dn = test::kCloseNoiseDn;
    settings.shape = test::tango_shape();
    network->configure(settings);
  }
  SightingStatus process(const std::vector<std::uint16_t>& pixels, const std::optional<Vector3>& predicted = {}) {
    const PoseSighting& sighting =
        network->process({5}, 7, test::view_of(pixels, test::kCloseWidth, test::kCloseHeight, 80, 50), predicted);
    EXPECT_EQ(sighting.time.ns, 5);
    EXPECT_EQ(sighting.image, 7);
    EXPECT_EQ(sighting.pnp.has_value(), sighting.status == SightingStatus::kPose);
    return sighting.status;
  }

  std::unique_ptr<SpacecraftPoseNetwork> network = std::make_unique<SpacecraftPoseNetwork>();
  const Vector3 ahead{0.0, 0.0, 8.0};
};

TEST_F(PoseNetworkTest, NoLight) {
  const auto pixels = CloseImage(1).stars_and_hot_pixels().expose();
  EXPECT_EQ(process(pixels), SightingStatus::kDark);
  EXPECT_EQ(process(pixels, ahead), SightingStatus::kDark);
  EXPECT_EQ(process(std::vector<std::uint16_t>(400'000, imaging::kMissingPixel), ahead), SightingStatus::kDark);
}

TEST_F(PoseNetworkTest, TooMuchLight) {
  const auto pixels = CloseImage(1).even_light(128000.0).expose();
  EXPECT_EQ(process(pixels), SightingStatus::kBlinded);
  EXPECT_EQ(process(pixels, ahead), SightingStatus::kBlinded);
}

TEST_F(PoseNetworkTest, TheEarthAlone) {
  EXPECT_EQ(process(CloseImage(1).limb(200.0, 100000.0).expose()), SightingStatus::kNoTarget);
}

/// Keypoints that a network sees in what is not its target agree on no pose.
TEST_F(PoseNetworkTest, ABrightBlobIsNoTarget) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto pixels =
        CloseImage(seed).box({.width = 150.0, .height = 150.0, .turn = 0.2 * static_cast<double>(seed)}).expose();
    EXPECT_NE(process(pixels), SightingStatus::kPose) << seed;
    EXPECT_NE(process(pixels, ahead), SightingStatus::kPose) << seed;
  }
}

TEST_F(PoseNetworkTest, NotItsFrame) {
  const std::vector<std::uint16_t> pixels(400'000, 64);
  const auto view = test::view_of(pixels, test::kCloseWidth, test::kCloseHeight, 0, 0);
  EXPECT_EQ(network->process({0}, 1, view, {}).status, SightingStatus::kInvalid);
  const std::vector<std::uint16_t> few(1000, 64);
  EXPECT_EQ(process(few), SightingStatus::kInvalid);
  EXPECT_EQ(std::make_unique<SpacecraftPoseNetwork>()->process({0}, 1, view, {}).status, SightingStatus::kInvalid)
      << "not configured";
}

TEST_F(PoseNetworkTest, APredictionBehindOrBesideTheImageIsNotFollowed) {
  const auto pixels = CloseImage(1).box({}).expose();
  for (const Vector3& wrong : {Vector3(0.0, 0.0, -8.0), Vector3(8.0, 0.0, 8.0), Vector3(0.0, 0.0, 0.0)}) {
    process(pixels, wrong);
    EXPECT_FALSE(network->sighting().region_is_predicted);
  }
  process(pixels, ahead);
  EXPECT_TRUE(network->sighting().region_is_predicted);
}

/// 2.2 times the farthest keypoint's distance, 0.725 m: f = 1450.5 px, 8 m.
TEST(RegionOf, TheSquareAroundAllKeypoints) {
  const CropRegion region = region_of({0.0, 0.0, 8.0}, test::close_camera(), test::tango_shape()).value();
  const double farthest = Vector3(0.5427, 0.4877 - 0.018823529411764704, 0.2591 - 0.160794117647059).norm();
  EXPECT_NEAR(region.side_px, 2.3 * farthest * 1450.5 / 8.0, 1e-9);
  EXPECT_EQ(region.centre_px, Vector2(479.75, 299.75));
  EXPECT_FALSE(region_of({0.0, 0.0, -8.0}, test::close_camera(), test::tango_shape()).ok());
  EXPECT_FALSE(region_of({0.0, 0.0, 0.0}, test::close_camera(), test::tango_shape()).ok());
}

}  // namespace

// The target as a bright box of known place among stars, shadow, stray light and the Earth's limb.

namespace {

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
