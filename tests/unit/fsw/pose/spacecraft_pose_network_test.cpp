// Images without a target, or of which nothing can be made: a status for each and never a pose.

#include "fsw/pose/spacecraft_pose_network.h"

#include <algorithm>
#include <memory>

#include <gtest/gtest.h>

#include "tests/support/tango_view.h"
#include "tests/unit/fsw/pose/close_images.h"

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
}  // namespace vbar::fsw::pose
