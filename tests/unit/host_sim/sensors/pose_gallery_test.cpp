// Which images of a run with navigation by poses go into its gallery, and what their pictures show, decoded by libpng.

#include "host_sim/sensors/camera/pose_gallery.h"

#include <array>
#include <cmath>
#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include "host_sim/sensors/camera/pose_picture.h"
#include "host_sim/sensors/sensor_kinds.h"
#include "host_sim/twins/camera/image_tiles.h"
#include "tests/unit/host_sim/sensors/editable_camera.h"

namespace vbar::sensors {
namespace {

using testing::HasSubstr;

using Colour = std::array<int, 3>;
constexpr Colour kBlack{0, 0, 0}, kWhite{255, 255, 255}, kMissing{60, 30, 70};

struct Decoded {
  explicit Decoded(const std::vector<std::uint8_t>& png) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    if (png_image_begin_read_from_memory(&image, png.data(), png.size()) == 0) return;
    image.format = PNG_FORMAT_RGB;
    width = static_cast<int>(image.width);
    height = static_cast<int>(image.height);
    rgb.resize(PNG_IMAGE_SIZE(image));
    png_image_finish_read(&image, nullptr, rgb.data(), 0, nullptr);
  }
  [[nodiscard]] Colour at(int x, int y) const {
    const auto k = static_cast<std::size_t>(3 * (y * width + x));
    return {rgb[k], rgb[k + 1], rgb[k + 2]};
  }
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

// ------------------------------------------------------------------------------------------------------------ pictures

constexpr int kWidth = 60, kHeight = 40;
constexpr int kCropLeft = kWidth + 8;  // the image, a gap, and the crop: 128 samples of 4 x 4 pixels
constexpr double kDark = 64.0, kNoise = 5.0;

/// Black is where the noise ends, at 84 DN, and white is 400 DN above it.
class PosePicture : public testing::Test {
 protected:
  void SetUp() override {
    dn_.assign(kWidth * kHeight, 484);
    set_dn(3, 5, 84);
    set_dn(4, 5, 50);
    set_dn(5, 5, 184);
    set_dn(6, 5, fsw::imaging::kMissingPixel);
    pose_.region_px[0] = 130.0;  // 30 and 20 in the image
    pose_.region_px[1] = 220.0;
    pose_.region_px[2] = 16.0;
  }
  void set_dn(int x, int y, std::uint16_t dn) { dn_[static_cast<std::size_t>(y * kWidth + x)] = dn; }
  [[nodiscard]] Decoded picture() {
    fsw::imaging::ImageView view;
    view.frame.width = kWidth;
    view.frame.height = kHeight;
    view.frame.origin_x = 100;
    view.frame.origin_y = 200;
    view.pixels = dn_;
    return Decoded(pose_picture(view, pose_, kDark, kNoise, *network_));
  }

  std::vector<std::uint16_t> dn_;
  telemetry_pose pose_{};
  std::unique_ptr<fsw::network::KeypointNetwork> network_ = std::make_unique<fsw::network::KeypointNetwork>();
};

TEST_F(PosePicture, ShowsRootsOfLightAboveTheNoise) {
  const Decoded shown = picture();
  ASSERT_EQ(shown.width, kCropLeft + 512);
  ASSERT_EQ(shown.height, 512);
  EXPECT_EQ(shown.at(0, 0), kWhite);
  EXPECT_EQ(shown.at(3, 5), kBlack);
  EXPECT_EQ(shown.at(4, 5), kBlack);
  EXPECT_EQ(shown.at(5, 5), (Colour{128, 128, 128})) << "a quarter of the light: half of 255, rounded";
  EXPECT_EQ(shown.at(6, 5), kMissing);
}

// The report draws the frame of the crop and the keypoints over the picture.
TEST_F(PosePicture, ShowsTheCropBesides) {
  const Decoded shown = picture();
  EXPECT_EQ(shown.at(kWidth + 2, 20), kBlack) << "the gap";
  EXPECT_EQ(shown.at(kCropLeft + 200, 300), kWhite) << "the crop is evenly lit";
}

TEST_F(PosePicture, WithoutACropIsTheImageAlone) {
  for (const double side : {0.0, -5.0, std::nan("")}) {
    pose_.region_px[2] = side;
    const Decoded shown = picture();
    EXPECT_EQ(shown.at(0, 0), kWhite) << side;
    EXPECT_EQ(shown.at(22, 20), kWhite) << side;
    EXPECT_EQ(shown.at(kCropLeft + 200, 300), kBlack) << side;
  }
}

TEST_F(PosePicture, OfNothingButMissingPixelsShowsThem) {
  dn_.assign(kWidth * kHeight, fsw::imaging::kMissingPixel);
  EXPECT_EQ(picture().at(0, 0), kBlack);
}

TEST_F(PosePicture, MapsOfTheNetworkLieOverTheCrop) {
  const Decoded without = picture();
  ASSERT_EQ(network_->load(fsw::network::weights_on_board()), fsw::Status::kOk);
  const Decoded with = picture();
  int different_in_image = 0, different_in_crop = 0;
  for (int y = 0; y < with.height; ++y)
    for (int x = 0; x < with.width; ++x)
      (x < kCropLeft ? different_in_image : different_in_crop) += with.at(x, y) != without.at(x, y);
  EXPECT_EQ(different_in_image, 0);
  EXPECT_GE(different_in_crop, 16 * 16) << "one cell of the maps at least";
}

// ------------------------------------------------------------------------------------------------------------- gallery

constexpr const char* kMission = R"(
[mission]
step_s = 60.0
duration_h = 1.5
[guidance]
mode = "idle"
[[spacecraft]]
name = "servicer"
flight_computer = {}
sensors.gnss = {}
sensors.camera = { camera = "tron", navigation = "pose", period_s = 60.0 }
actuators.thruster = {}
attitude = { profile = "commanded" }
elements = { kind = "mean", semi_major_axis_km = 7000, ex = 0, ey = 0, inclination_deg = 90, raan_deg = 0, mean_argument_of_latitude_deg = 0 }
[[spacecraft]]
name = "target"
model = "tango"
attitude = { profile = "tumble" }
relative = { to = "servicer", a_roe_m = [0, -10, 0, 0, 0, 0] }
)";
constexpr twins::camera::Region kRegion{660, 300, 80, 50};
constexpr fsw::Duration kMinute{60'000'000'000};

class PoseGalleryTest : public testing::Test {
 protected:
  /// The image of a minute, each a little brighter than the one before, and what is said of it, a step later.
  void fly_image(int minute, int told_number = -1) {
    const fsw::GpsTime exposure{mission_.start_time().ns + minute * kMinute.ns};
    const std::vector<std::uint16_t> dn(kRegion.width * kRegion.height, static_cast<std::uint16_t>(100 + minute));
    gallery_.on_inputs(exposure + kMinute, twins::camera::image_tiles({exposure, minute, 1, 0}, kRegion, 8, dn));
    telemetry_pose pose{};
    pose.image = told_number >= 0 ? told_number : minute;
    PoseRow row = row_;
    row.time_s = 60.0 * minute;
    row.image = pose.image;
    gallery_.on_pose(exposure, pose, row, pictures_);
  }

  [[nodiscard]] std::vector<int> minutes() const {
    std::vector<int> all;
    for (const report::GalleryImage& picture : pictures_) all.push_back(picture.image);
    return all;
  }

  const mission::Mission mission_ = sensors::parse_mission(kMission, "m.toml");
  PoseGallery gallery_{mission_, mission_.spacecraft[0]};
  PoseRow row_;
  std::vector<report::GalleryImage> pictures_;
};

// Nine even times of 90 minutes: every tenth minute from the start.
TEST_F(PoseGalleryTest, TakesTheFirstImageAtEachOfNineEvenTimes) {
  for (int minute = 1; minute < 90; ++minute) {
    if (minute >= 38 && minute < 43) continue;  // no images
    fly_image(minute);
  }
  EXPECT_THAT(minutes(), testing::ElementsAre(1, 10, 20, 30, 43, 50, 60, 70, 80));
  EXPECT_EQ(pictures_[1].time_s, 600.0);
  const Decoded shown(pictures_[1].png);
  EXPECT_EQ(shown.width, kRegion.width + 8 + 512);
  EXPECT_EQ(shown.at(0, 0), kWhite);
}

TEST_F(PoseGalleryTest, AGapLongerThanAPeriodIsOnePicture) {
  for (const int minute : {1, 35, 36, 40}) fly_image(minute);
  EXPECT_THAT(minutes(), testing::ElementsAre(1, 35, 40));
}

TEST_F(PoseGalleryTest, TelemetryOfAnotherImageIsNotItsPicture) {
  fly_image(1, 7);
  EXPECT_TRUE(pictures_.empty());
  fly_image(2);
  EXPECT_THAT(minutes(), testing::ElementsAre(2));
}

TEST_F(PoseGalleryTest, CaptionSaysWhatIsKnown) {
  fly_image(1);
  EXPECT_EQ(pictures_.at(0).caption, "pose");
  row_.range_m = 8.04;
  row_.pnp_inliers = 9;
  row_.pnp_error_deg = 2.26;
  row_.attitude_error_deg = 1.0;
  row_.sunlit = 0.25;
  fly_image(10);
  EXPECT_EQ(pictures_.at(1).caption,
            "true range 8.0 m, pose by 9 keypoints, PnP 2.3 deg off, filter 1.0 deg off, 25 % of the Sun in sight");
}

TEST_F(PoseGalleryTest, NeedsACameraThatNavigatesByPoses) {
  mission::Mission other = mission_;
  editable_camera(other.spacecraft[0]).navigation = CameraSensor::kBearings;
  PoseGallery by_angles(other, other.spacecraft[0]);
  remove_camera(other.spacecraft[0]);
  PoseGallery blind(other, other.spacecraft[0]);
  for (PoseGallery* gallery : {&by_angles, &blind}) {
    gallery->on_inputs(mission_.start_time(), {});
    gallery->on_pose(mission_.start_time(), {}, {}, pictures_);
  }
  EXPECT_TRUE(pictures_.empty());
}

}  // namespace
}  // namespace vbar::sensors
