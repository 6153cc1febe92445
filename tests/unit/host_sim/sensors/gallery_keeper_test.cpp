// Which images of a run go into its gallery, and what they show. Images are patterns that differ by number; what the
// gallery should hold is drawn from the same patterns.

#include "host_sim/sensors/camera/gallery_keeper.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/sensors/sensor_kinds.h"
#include "host_sim/twins/camera/image_tiles.h"

namespace vbar::sensors {
namespace {

using testing::HasSubstr;

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
constexpr fsw::Duration kMinute{60'000'000'000};

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
  GalleryKeeper keeper_{mission_, mission_.spacecraft[0]};
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
  GalleryKeeper keeper(mission_, mission_.spacecraft[0], [&](const twins::TruthSnapshot& truth, std::int64_t number) {
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
  GalleryKeeper keeper(mission_, mission_.spacecraft[0],
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
  GalleryKeeper keeper(blind, blind.spacecraft[0]);
  keeper.on_inputs(blind.start_time(), {});
  keeper.on_image({blind.start_time(), {}, nullptr}, pictures_);
  keeper.finish(pictures_);
  EXPECT_TRUE(pictures_.empty());
}

}  // namespace
}  // namespace vbar::sensors
