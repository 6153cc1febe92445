// Light of an image: where the Earth is as the target sees it.

#include "hil_drivers/tron/lights/room_light.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/paths.h"

namespace vbar::tron {
namespace {

using fsw::Vector3;

class RoomLightTest : public ::testing::Test {
 protected:
  RoomLightTest() {
    place_.posture.target_rad << 0.1, -1.2, 1.3, 0.2, 0.4, 0.3;
    place_.lamp_azimuth_rad = 1.7;
    T_L_T_ = T_L_T_of_arm(calibration_, place_.posture);
    scene_.sunlit = 0.7;
    scene_.earth_to_sun = 0.2;
    scene_.T_C_T.linear() = Eigen::AngleAxisd(2.0, Vector3(1, 2, 3).normalized()).toRotationMatrix();
    scene_.T_C_T.translation() = Vector3(0, 0, 3);
  }
  /// The Earth in this direction of the laboratory.
  void put_earth(const Vector3& direction_L) {
    scene_.earth_C = scene_.T_C_T.linear() * T_L_T_.linear().transpose() * direction_L.normalized();
  }

  BenchFile bench_ = read_bench_file(tests::source_path("data/benches/tron.toml"));
  Calibration calibration_ = calibration_as_designed(bench_);
  Scene scene_;
  Place place_;
  Eigen::Isometry3d T_L_T_;
};

TEST_F(RoomLightTest, ShinesFromTheSideOnWhichTheTargetSeesTheEarth) {
  RoomLight light(bench_, calibration_, {});
  const Vector3 middle = T_L_T_ * (0.25 * (bench_.target.body_low_m + bench_.target.body_high_m));
  for (const double side : {-1.0, 1.0}) {
    put_earth(Vector3(0, side, 0));
    const LightLevels levels = light.levels(scene_, place_);
    double here = 0, there = 0;
    for (std::size_t k = 0; k < kBoxes; ++k) {
      const double y = bench_.boxes.boxes[k].centre_m.y();
      if (std::abs(y) > 1.0) (y * side > 0.0 ? here : there) += levels.box_power[k];  // of the side walls
    }
    EXPECT_GT(here, 5.0 * there) << side;
    const BoxPowers expected = BoxLight(bench_).powers(middle, {Vector3(0, side, 0), scene_.earth_half_angle, 0.2});
    for (std::size_t k = 0; k < kBoxes; ++k) EXPECT_NEAR(levels.box_power[k], expected.power[k], 1e-9);
    ASSERT_TRUE(levels.earth_misfit);
    EXPECT_NEAR(*levels.earth_misfit, expected.misfit, 1e-9);
  }
}

TEST_F(RoomLightTest, TheLampIsTheVisiblePartOfTheSun) {
  RoomLight light(bench_, calibration_, {});
  const LightLevels levels = light.levels(scene_, place_);
  EXPECT_EQ(levels.lamp_power, 0.7);
  EXPECT_EQ(levels.lamp_azimuth_rad, 1.7);
  EXPECT_NEAR(exposure_factor(bench_.lamp), 10.0, 1e-12);  // irradiance 0.1 of the Sun's
}

TEST_F(RoomLightTest, WithoutEarthLightTheBoxesAreOff) {
  RoomLight light(bench_, calibration_, {});
  scene_.earth_to_sun = 0.0;
  const LightLevels levels = light.levels(scene_, place_);
  for (const double power : levels.box_power) EXPECT_EQ(power, 0.0);
  EXPECT_FALSE(levels.earth_misfit);
}

}  // namespace
}  // namespace vbar::tron
