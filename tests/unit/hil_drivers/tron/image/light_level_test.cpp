#include "hil_drivers/tron/image/light_level.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace vbar::tron {
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
