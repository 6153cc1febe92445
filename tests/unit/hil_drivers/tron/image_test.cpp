#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "hil_drivers/tron/imaging/image_finish.h"
#include "host_sim/engine/random_stream.h"
#include "host_sim/twins/camera/optics.h"

namespace vbar::tron {

namespace {

TEST(TronBackground, LevelOfADarkImageIgnoresHotPixels) {
  engine::RandomStream random(1, "dark");
  std::vector<std::uint16_t> dn(40000);
  for (auto& value : dn) value = static_cast<std::uint16_t>(std::lround(64.0 + 2.5 * random.normal()));
  for (std::size_t k = 0; k < 200; ++k) dn[k * 17] = 4000;
  const DarkLevel level = dark_level(dn);
  EXPECT_NEAR(level.offset_dn, 64.0, 0.1);
  EXPECT_NEAR(level.noise_dn, 2.5, 0.15);
  EXPECT_THROW(static_cast<void>(dark_level(std::span(dn).first(99))), std::invalid_argument);
}

TEST(TronBackground, GrowsByADisc) {
  constexpr int kWidth = 21;
  std::vector<float> covered(kWidth * kWidth, 0.0F);
  covered[10 * kWidth + 10] = 0.5F;
  const auto mask = grown(covered, kWidth, 4);
  for (int y = 0; y < kWidth; ++y)
    for (int x = 0; x < kWidth; ++x)
      EXPECT_EQ(mask[static_cast<std::size_t>(y * kWidth + x)], (x - 10) * (x - 10) + (y - 10) * (y - 10) <= 16)
          << x << ' ' << y;
}

TEST(TronBackground, GrowsFromTheEdgeOfTheImage) {
  std::vector<float> covered(100, 0.0F);
  covered[0] = 1.0F;
  covered[99] = 1.0F;
  const auto mask = grown(covered, 10, 3);
  EXPECT_EQ(mask[3], 1);
  EXPECT_EQ(mask[4], 0);
  EXPECT_EQ(mask[96], 1);
  EXPECT_EQ(mask[9], 0);
}

TEST(TronBackground, NoiseIsThatOfTheDarkImage) {
  std::vector<std::uint8_t> mask(100000, 0);
  for (std::size_t k = 0; k < 1000; ++k) mask[k] = 1;
  std::vector<std::uint16_t> dn(mask.size(), 1234), again = dn, other = dn;
  replace_background(mask, {64.0, 3.0}, 7, 5, 4095, dn);
  replace_background(mask, {64.0, 3.0}, 7, 5, 4095, again);
  replace_background(mask, {64.0, 3.0}, 7, 6, 4095, other);
  EXPECT_EQ(dn, again);
  EXPECT_NE(dn, other);
  for (std::size_t k = 0; k < 1000; ++k) ASSERT_EQ(dn[k], 1234);
  const DarkLevel level = dark_level(std::span(dn).subspan(1000));
  EXPECT_NEAR(level.offset_dn, 64.0, 0.1);
  EXPECT_NEAR(level.noise_dn, 3.0, 0.1);
  dn.pop_back();
  EXPECT_THROW(replace_background(mask, {64.0, 3.0}, 7, 5, 4095, dn), std::invalid_argument);
}

/// A square of 1 m at 10 m, and a lens of 100 px a radian: 10 px from 44.5 to 54.5, and one more on each side.
class TronOutline : public testing::Test {
 protected:
  TronOutline() {
    camera_.optics.focal_length_mm = 10.0;
    camera_.optics.principal_point_px = {49.5, 49.5};
    camera_.detector = {.width = 100, .height = 100, .pixel_pitch_um = 100.0};
    camera_.region = {0, 0, 100, 100};
    const fsw::Vector3 a(-0.5, -0.5, 0.0), b(0.5, -0.5, 0.0), c(0.5, 0.5, 0.0), d(-0.5, 0.5, 0.0);
    const std::array<fsw::Vector3, 3> flat{fsw::Vector3::Zero(), fsw::Vector3::Zero(), fsw::Vector3::Zero()};
    twins::camera::Silhouette square(
        twins::camera::make_cad_model("square", {{{a, b, c}, flat, 0}, {{a, c, d}, flat, 0}}, {{.name = "white"}}));
    Eigen::Isometry3d T_C_B = Eigen::Isometry3d::Identity();
    T_C_B.translation().z() = 10.0;
    outline_ = outline_of(square, twins::camera::Optics(camera_), T_C_B, camera_.region);
  }

  [[nodiscard]] static std::size_t at(int x, int y) { return static_cast<std::size_t>(100 * y + x); }

  twins::camera::CameraSettings camera_;
  Outline outline_;
};

TEST_F(TronOutline, MaskOfASquare) {
  int row = 0;
  for (int x = 0; x < 100; ++x) row += outline_.mask[at(x, 50)];
  EXPECT_EQ(row, 12);
  EXPECT_EQ(outline_.mask[at(50, 10)], 0);
  EXPECT_NEAR(outline_.covered[at(50, 50)], 1.0, 1e-6);
  EXPECT_NEAR(outline_.covered[at(45, 50)], 0.75, 1e-6);  // the edge of the square is that of this pixel
  EXPECT_NEAR(outline_.covered[at(44, 50)], 0.25, 1e-6);
  EXPECT_EQ(outline_.covered[at(42, 50)], 0.0F);
}

// Each pixel is the mixture of target and wall that the lens makes of it; the wall is brighter to the right.
TEST_F(TronOutline, TheWallIsSubtractedFromTheMargin) {
  const DarkLevel dark{64.0, 2.0};
  std::vector<std::uint16_t> dn(outline_.covered.size());
  const auto wall = [](int x) { return 40.0 + 2.0 * x; };
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) {
      const double share = outline_.covered[at(x, y)];
      dn[at(x, y)] = static_cast<std::uint16_t>(std::lround(64.0 + share * 1000.0 + (1.0 - share) * wall(x)));
    }
  const std::vector<std::uint16_t> before = dn;
  subtract_background(outline_, dark, dn);
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x)
      if (outline_.mask[at(x, y)] != 0)
        EXPECT_NEAR(dn[at(x, y)], 64.0 + outline_.covered[at(x, y)] * 1000.0, 10.0) << x << ' ' << y;
      else
        EXPECT_EQ(dn[at(x, y)], before[at(x, y)]);
  dn.pop_back();
  EXPECT_THROW(subtract_background(outline_, dark, dn), std::invalid_argument);
}

TEST_F(TronOutline, ABackgroundDarkerThanADarkImageIsNotAdded) {
  std::vector<std::uint16_t> dn(outline_.covered.size(), 60);
  subtract_background(outline_, {64.0, 2.0}, dn);
  EXPECT_EQ(dn, std::vector<std::uint16_t>(dn.size(), 60));
}

}  // namespace

namespace {

TEST(TronBinning, TakesMeansOfFour) {
  const std::vector<std::uint16_t> dn{0, 4, 4095, 4095,  //
                                      8, 4, 4095, 4095,  //
                                      1, 0, 1,    1,     //
                                      0, 0, 0,    0};
  EXPECT_EQ(binned_by_two(dn, 4, 4), (std::vector<std::uint16_t>{4, 4095, 0, 1}));
}

TEST(TronBinning, RefusesOtherSizes) {
  const std::vector<std::uint16_t> dn(12);
  EXPECT_THROW(static_cast<void>(binned_by_two(dn, 4, 4)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(binned_by_two(dn, 3, 4)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(binned_by_two({}, 0, 0)), std::invalid_argument);
}

}  // namespace

// From a frame to an image: what the light of a grey square says of lamp and boxes.

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

namespace {

/// A Lambert square of 1 m^2 and albedo 0.5 that faces lamp and camera at 10 m: E rho / pi / d^2.
TEST(TronLightLevel, OfALambertSquare) {
  const fsw::Vector3 a(-0.5, -0.5, 0.0), b(0.5, -0.5, 0.0), c(0.5, 0.5, 0.0), d(-0.5, 0.5, 0.0);
  const std::array<fsw::Vector3, 3> flat{fsw::Vector3::Zero(), fsw::Vector3::Zero(), fsw::Vector3::Zero()};
  const auto model = twins::camera::make_cad_model("square", {{{a, c, b}, flat, 0}, {{a, d, c}, flat, 0}},
                                                   {{.name = "grey", .diffuse = {0.5, 0.5, 0.5}}});
  ExpectedLight expected(model);
  Eigen::Isometry3d T_C_B = Eigen::Isometry3d::Identity();
  T_C_B.translation().z() = 10.0;
  TargetLight light;
  light.sun_C = -fsw::Vector3::UnitZ();
  light.sun_photons_per_m2_s = 1e20;
  twins::camera::CameraSettings camera;
  camera.exposure_s = 1e-4;
  const double photons_per_m2 = 1e20 * 0.5 / std::numbers::pi / 100.0 * 1e-4;
  EXPECT_NEAR(expected.electrons(T_C_B, light, camera) / (photons_per_m2 * camera.electrons_per_photon_m2()), 1.0,
              0.02);
  light.sun_photons_per_m2_s = 0.0;
  EXPECT_EQ(expected.electrons(T_C_B, light, camera), 0.0);
}

TEST(TronLightLevel, MeasuresInsideTheMaskOnly) {
  const std::vector<std::uint16_t> dn{100, 64, 74, 5000};
  const std::vector<std::uint8_t> mask{1, 1, 1, 0};
  EXPECT_DOUBLE_EQ(measured_electrons(dn, mask, 64.0, 0.5), (36.0 + 10.0) / 0.5);
}

}  // namespace

}  // namespace vbar::tron
