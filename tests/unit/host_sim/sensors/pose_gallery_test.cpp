// Which images of a run with navigation by poses go into its gallery, and what their pictures show, decoded by libpng.

#include "host_sim/sensors/camera/pose_gallery.h"

#include <array>
#include <cmath>
#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/sensors/camera/image_gallery.h"
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
  std::unique_ptr<fsw::pose::KeypointNetwork> network_ = std::make_unique<fsw::pose::KeypointNetwork>();
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
  ASSERT_EQ(network_->load(fsw::pose::weights_on_board()), fsw::Status::kOk);
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

// Which images of a run go into its gallery, and what they show. Images are patterns that differ by number; what the
// gallery should hold is drawn from the same patterns.

namespace {

// Waypoints at one and two hours; the run ends half an hour later. An exposure every minute, from minute one.
constexpr const char* kGalleryMission = R"(
[mission]
step_s = 60.0
duration_h = 2.5
[guidance]
mode = "idle"
[[spacecraft]]
name = "servicer"
flight_computer = {}
sensors.gnss = {}
sensors.camera = { period_s = 60.0 }
actuators.thruster = {}
attitude = { profile = "commanded" }
elements = { kind = "mean", semi_major_axis_km = 7000, ex = 0, ey = 0, inclination_deg = 90, raan_deg = 0, mean_argument_of_latitude_deg = 0 }
[[spacecraft]]
name = "target"
body = "tango"
model = "tango"
attitude = { profile = "tumble" }
relative = { to = "servicer", waypoint = 0 }
[[waypoint]]
index = 0
time_h = 0.0
a_roe_m = [0, -1e4, 0, 0, 0, 0]
[[waypoint]]
index = 1
time_h = 1.0
a_roe_m = [0, -5e3, 0, 0, 0, 0]
[[waypoint]]
index = 2
time_h = 2.0
a_roe_m = [0, -1e3, 0, 0, 0, 0]
)";

constexpr int kBearing = 0, kNoTarget = 5;
constexpr twins::camera::Region kImageRegion{710, 200, 80, 50};  // 4000 pixels: 4 tiles of 868 and one of 528

std::vector<std::uint16_t> pattern(int number) {
  std::vector<std::uint16_t> dn;
  for (int k = 0; k < kImageRegion.width * kImageRegion.height; ++k)
    dn.push_back(static_cast<std::uint16_t>((k * 37 + number * 101) % 4096));
  return dn;
}

std::vector<std::uint8_t> png(std::vector<std::uint16_t> dn) {
  const report::CameraPicture picture{kImageRegion.width, kImageRegion.height, dn};
  return report::png_of(picture, report::stretch_for(picture));
}

class Gallery : public testing::Test {
 protected:
  /// The image of a minute and what is said of it, at the step of the minute after.
  void fly_image(int minute, int status, const telemetry_objects* objects = nullptr, int lost_tile = -1) {
    const fsw::GpsTime exposure{mission_.start_time().ns + minute * kMinute.ns};
    const int number = minute - 1;
    auto tiles = twins::camera::image_tiles({exposure, number, 1, 0}, kImageRegion, 12, pattern(number));
    if (lost_tile >= 0) tiles.erase(tiles.begin() + lost_tile);
    keeper_.on_inputs(exposure + kMinute, tiles);
    ImageRow row;
    row.time_s = 60.0 * minute;
    row.image = number;
    row.status = status;
    row.tiles_missing = lost_tile >= 0 ? 1 : 0;
    row.range_m = range_m_;
    keeper_.on_image({exposure, row, objects}, pictures_);
  }

  [[nodiscard]] std::vector<int> minutes() const {
    std::vector<int> all;
    for (const report::GalleryImage& picture : pictures_) all.push_back(picture.image + 1);
    return all;
  }

  const mission::Mission mission_ = sensors::parse_mission(kGalleryMission, "m.toml");
  GalleryRecorder keeper_{mission_, mission_.spacecraft[0]};
  std::vector<report::GalleryImage> pictures_;
  double range_m_ = 12345.6;
};

TEST_F(Gallery, HoldsTheFirstBearingAndTheLastOnesBeforeWaypoints) {
  for (int minute = 1; minute < 150; ++minute) {
    const bool is_dark = minute < 5 || (minute > 51 && minute < 70) || (minute > 90 && minute < 130);
    fly_image(minute, is_dark ? kNoTarget : kBearing);
  }
  keeper_.finish(pictures_);
  // Before the second waypoint all that are looked at are dark: 101 to 120.
  EXPECT_THAT(minutes(), testing::ElementsAre(5, 51, 120, 149));
  for (const report::GalleryImage& picture : pictures_) {
    EXPECT_EQ(picture.time_s, 60.0 * (picture.image + 1));
    EXPECT_EQ(picture.png, png(pattern(picture.image)));
  }
  EXPECT_THAT(pictures_[1].caption, HasSubstr("range 12.35 km"));
  EXPECT_THAT(pictures_[2].caption, HasSubstr("no target"));
}

TEST_F(Gallery, TakesTheImageOfTheWaypointsOwnTime) {
  for (int minute = 1; minute <= 61; ++minute) fly_image(minute, kBearing);
  EXPECT_THAT(minutes(), testing::ElementsAre(1, 60));
}

// The report draws its marks by these; pixels hold none.
TEST_F(Gallery, SaysWhichPixelsItShowsAndHowLargeTheTargetIs) {
  fly_image(1, kBearing);
  ASSERT_EQ(pictures_.size(), 1U);
  const report::GalleryImage& picture = pictures_[0];
  EXPECT_EQ(picture.png, png(pattern(0)));
  EXPECT_EQ(picture.origin_x_px, 710);
  EXPECT_EQ(picture.origin_y_px, 200);
  EXPECT_EQ(picture.width_px, 80);
  EXPECT_EQ(picture.height_px, 50);
  EXPECT_EQ(picture.crop_side, 0);
  EXPECT_EQ(picture.target_radius_px, 13.0) << "a point at 12 km";
}

// Tango's 0.73 m are 5972.7 px * 0.73 m / range: 21.8 px of 200 m.
TEST_F(Gallery, ANearTargetsMarkIsItsSize) {
  range_m_ = 200.0;
  fly_image(1, kBearing);
  ASSERT_EQ(pictures_.size(), 1U);
  const double radius_px = 0.73 * 35e3 / 5.86 / 200.0;
  EXPECT_NEAR(pictures_[0].target_radius_px, radius_px, 1e-9);
  EXPECT_THAT(pictures_[0].caption, HasSubstr("range 200.0 m"));
}

TEST_F(Gallery, PixelsOfALostTileAreMissing) {
  fly_image(1, kBearing, nullptr, 2);
  ASSERT_EQ(pictures_.size(), 1U);
  std::vector<std::uint16_t> dn = pattern(0);
  std::fill(dn.begin() + 2 * 868, dn.begin() + 3 * 868, std::uint16_t{0xFFFF});
  EXPECT_EQ(pictures_[0].png, png(dn));
  EXPECT_THAT(pictures_[0].caption, HasSubstr("1 tiles missing"));
}

// The image of the twin is asked for at the truth and with the number of the exposure, of kept images only.
TEST_F(Gallery, ImageOfATestbedStandsBesideThatOfTheTwin) {
  std::vector<std::int64_t> asked;
  GalleryRecorder keeper(mission_, mission_.spacecraft[0], [&](const twins::TruthSnapshot& truth, std::int64_t number) {
    EXPECT_EQ(truth.time, mission_.start_time() + fsw::Duration{(number + 1) * kMinute.ns});
    asked.push_back(number);
    return pattern(static_cast<int>(number) + 1);
  });
  const auto fly = [&](int minute, bool has_truth) {
    const fsw::GpsTime exposure{mission_.start_time().ns + minute * kMinute.ns};
    keeper.on_inputs(exposure + kMinute,
                     twins::camera::image_tiles({exposure, minute - 1, 1, 0}, kImageRegion, 12, pattern(minute - 1)));
    ImageRow row;
    row.image = minute - 1;
    row.status = kBearing;
    const twins::TruthSnapshot truth{exposure, {}};
    keeper.on_image({exposure, row, nullptr, has_truth ? &truth : nullptr}, pictures_);
  };
  fly(1, true);
  for (int minute = 50; minute < 59; ++minute) fly(minute, true);
  fly(59, false);
  keeper.finish(pictures_);
  ASSERT_EQ(pictures_.size(), 2U);
  EXPECT_EQ(asked, std::vector<std::int64_t>{0});
  const std::vector<std::uint16_t> testbed = pattern(0), twin = pattern(1);
  const report::CameraPicture own{kImageRegion.width, kImageRegion.height, testbed};
  EXPECT_EQ(pictures_[0].twin_png,
            report::png_of({kImageRegion.width, kImageRegion.height, twin}, report::stretch_for(own)))
      << "stretched as the testbed's";
  EXPECT_FALSE(pictures_[0].difference.empty());
  EXPECT_FALSE(pictures_[0].difference_png.empty());
  EXPECT_TRUE(pictures_[1].difference.empty()) << "without a truth there is no exposure";
}

TEST_F(Gallery, TwinThatFailsDoesNotEndTheRun) {
  GalleryRecorder keeper(mission_, mission_.spacecraft[0],
                         [](const twins::TruthSnapshot&, std::int64_t) -> std::vector<std::uint16_t> {
                           throw std::runtime_error("no context");
                         });
  const fsw::GpsTime exposure{mission_.start_time().ns + kMinute.ns};
  keeper.on_inputs(exposure, twins::camera::image_tiles({exposure, 0, 1, 0}, kImageRegion, 12, pattern(0)));
  const twins::TruthSnapshot truth{exposure, {}};
  keeper.on_image({exposure, {}, nullptr, &truth}, pictures_);
  ASSERT_EQ(pictures_.size(), 1U);
  EXPECT_THAT(pictures_[0].caption, HasSubstr("no image of the digital twin: no context"));
  EXPECT_TRUE(pictures_[0].difference.empty());
}

TEST_F(Gallery, NeedsACamera) {
  mission::Mission blind = mission_;
  std::erase_if(blind.spacecraft[0].sensors, [](const mission::Sensor& sensor) { return sensor.kind == "camera"; });
  GalleryRecorder keeper(blind, blind.spacecraft[0]);
  keeper.on_inputs(blind.start_time(), {});
  keeper.on_image({blind.start_time(), {}, nullptr}, pictures_);
  keeper.finish(pictures_);
  EXPECT_TRUE(pictures_.empty());
}

}  // namespace

}  // namespace vbar::sensors
