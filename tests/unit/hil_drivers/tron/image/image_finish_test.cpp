// From a frame to an image: what the light of a grey square says of lamp and boxes.

#include "hil_drivers/tron/image/image_finish.h"

#include <cmath>

#include <gtest/gtest.h>

namespace vbar::tron {
namespace {

twins::camera::CadModel grey_square(double specular = 0.0) {
  const fsw::Vector3 a(-0.5, -0.5, 0.0), b(0.5, -0.5, 0.0), c(0.5, 0.5, 0.0), d(-0.5, 0.5, 0.0);
  const std::array<fsw::Vector3, 3> flat{fsw::Vector3::Zero(), fsw::Vector3::Zero(), fsw::Vector3::Zero()};
  return twins::camera::make_cad_model(
      "square", {{{a, c, b}, flat, 0}, {{a, d, c}, flat, 0}},
      {{.name = "grey", .diffuse = {0.5, 0.5, 0.5}, .specular = {specular, specular, specular}, .exponent = 200.0}});
}

/// The square at 10 m is 20 px wide, lit by Sun and Earth from behind the camera.
class TronImageFinish : public testing::Test {
 protected:
  TronImageFinish() {
    camera_.optics.focal_length_mm = 20.0;
    camera_.optics.principal_point_px = {49.5, 49.5};
    camera_.detector.width = camera_.detector.height = 100;
    camera_.detector.pixel_pitch_um = 100.0;
    camera_.detector.bits = 12;
    camera_.detector.gain_dn_per_electron = 1e-3;
    camera_.region = {0, 0, 100, 100};
    camera_.exposure_s = 1e-4;
    T_C_B_.translation().z() = 10.0;
    light_.sun_C = light_.earth_C = -fsw::Vector3::UnitZ();
    light_.sun_photons_per_m2_s = 1e20;
    light_.earth_photons_per_m2_s = 3e19;
    TargetLight earth_only = light_;
    earth_only.sun_photons_per_m2_s = 0.0;
    ExpectedLight expected(grey_square());
    all_ = expected.electrons(T_C_B_, light_, camera_);
    earth_ = expected.electrons(T_C_B_, earth_only, camera_);
  }

  /// Of the square's 400 pixels, each four of the detector's.
  [[nodiscard]] FinishedImage of_electrons(double electrons) const {
    std::vector<std::uint16_t> dark(200 * 200, kDark), frame = dark;
    const double dn = electrons / 400.0 * camera_.detector.gain_dn_per_electron;  // a binned pixel is a mean
    for (int y = 80; y < 120; ++y)
      for (int x = 80; x < 120; ++x)
        frame[static_cast<std::size_t>(200 * y + x)] = static_cast<std::uint16_t>(std::lround(kDark + dn));
    return ImageFinish(camera_, square(), dark, 1).finish(frame, 0, T_C_B_, light_);
  }

  [[nodiscard]] twins::camera::CadModel square() const { return grey_square(specular_); }

  static constexpr std::uint16_t kDark = 64;
  double specular_ = 0.0;
  twins::camera::CameraSettings camera_;
  Eigen::Isometry3d T_C_B_ = Eigen::Isometry3d::Identity();
  TargetLight light_;
  double all_ = 0.0, earth_ = 0.0;
};

TEST_F(TronImageFinish, LightAsPredictedHasLevelOne) {
  ASSERT_GT(earth_, 1e5);
  const FinishedImage image = of_electrons(all_);
  EXPECT_EQ(image.dn.size(), 10000U);
  EXPECT_NEAR(image.light_level.value(), 1.0, 0.02);
  EXPECT_NEAR(image.sunlight_level.value(), 1.0, 0.02);
}

TEST_F(TronImageFinish, WithoutTheLampNothingIsLeftOfSunlight) {
  const FinishedImage image = of_electrons(earth_);
  EXPECT_NEAR(image.light_level.value(), earth_ / all_, 0.02);
  EXPECT_NEAR(image.sunlight_level.value(), 0.0, 0.03);
}

// The model's glint may be brighter than the diffuse light of all its faces; a mock-up that is less glossy is lit all
// the same.
TEST_F(TronImageFinish, AGlintThatIsMissingIsNotADarkLamp) {
  specular_ = 0.3;
  TargetLight sun_only = light_;
  sun_only.earth_photons_per_m2_s = 0.0;
  ASSERT_GT(ExpectedLight(square()).electrons(T_C_B_, sun_only, camera_), 5.0 * (all_ - earth_));
  const FinishedImage image = of_electrons(all_);
  EXPECT_LT(image.light_level.value(), 0.3);
  EXPECT_NEAR(image.sunlight_level.value(), 1.0, 0.3);
}

TEST_F(TronImageFinish, NothingIsSaidOfSunlightWhereTheEarthsIsStronger) {
  light_.sun_photons_per_m2_s = 0.5 * light_.earth_photons_per_m2_s;
  const FinishedImage image = of_electrons(earth_);
  EXPECT_TRUE(image.light_level.has_value());
  EXPECT_FALSE(image.sunlight_level.has_value());
}

}  // namespace
}  // namespace vbar::tron
