#include "hil_drivers/tron/image/background.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

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

/// A square of 1 m at 10 m, and a lens of 100 px a radian: 10 px, and 4 more on each side.
TEST(TronBackground, MaskOfASquare) {
  twins::camera::CameraSettings camera;
  camera.optics.focal_length_mm = 10.0;
  camera.optics.principal_point_px = {49.5, 49.5};
  camera.detector = {.width = 100, .height = 100, .pixel_pitch_um = 100.0};
  camera.region = {0, 0, 100, 100};
  const fsw::Vector3 a(-0.5, -0.5, 0.0), b(0.5, -0.5, 0.0), c(0.5, 0.5, 0.0), d(-0.5, 0.5, 0.0);
  const std::array<fsw::Vector3, 3> flat{fsw::Vector3::Zero(), fsw::Vector3::Zero(), fsw::Vector3::Zero()};
  const auto model =
      twins::camera::make_cad_model("square", {{{a, b, c}, flat, 0}, {{a, c, d}, flat, 0}}, {{.name = "white"}});
  TargetMask mask(model);
  Eigen::Isometry3d T_C_B = Eigen::Isometry3d::Identity();
  T_C_B.translation().z() = 10.0;
  const auto drawn = mask.draw(twins::camera::Optics(camera), T_C_B, camera.region);
  int row = 0;
  for (std::size_t x = 0; x < 100; ++x) row += drawn[50 * 100 + x];
  EXPECT_EQ(row, 18);
  EXPECT_EQ(drawn[10 * 100 + 50], 0);
}

}  // namespace
}  // namespace vbar::tron
