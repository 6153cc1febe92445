// The lens against the formulas written out, against finite differences, and back and forth.

#include "host_sim/twins/camera/optics.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace {

using vbar::fsw::Vector2;
using vbar::fsw::Vector3;
namespace camera = vbar::twins::camera;

camera::CameraSettings distorted() {
  camera::CameraSettings settings;
  settings.optics.distortion = {-0.12, 0.08, 1.5e-3, -7e-4, 0.02};
  settings.optics.principal_point_px = {963.2, 596.7};
  return settings;
}

// As in OpenCV's documentation of camera calibration, coefficients k1, k2, p1, p2, k3.
TEST(Optics, projects_as_the_formulas_of_brown_and_conrady) {
  const camera::CameraSettings settings = distorted();
  const camera::Optics optics(settings);
  const double f = 35e-3 / 5.86e-6;
  for (const auto& d :
       {Vector3(0.0, 0.0, 1.0), Vector3(0.12, -0.05, 1.0), Vector3(-0.15, 0.09, 0.9), Vector3(0.02, 0.099, 1.1)}) {
    const double x = d.x() / d.z(), y = d.y() / d.z(), r2 = x * x + y * y;
    const double radial = 1.0 - 0.12 * r2 + 0.08 * r2 * r2 + 0.02 * r2 * r2 * r2;
    const double u = x * radial + 2.0 * 1.5e-3 * x * y - 7e-4 * (r2 + 2.0 * x * x);
    const double v = y * radial + 1.5e-3 * (r2 + 2.0 * y * y) - 2.0 * 7e-4 * x * y;
    const auto pixel = optics.project(7.0 * d);
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), f * u + 963.2, 1e-9);
    EXPECT_NEAR(pixel->y(), f * v + 596.7, 1e-9);
  }
}

TEST(Optics, sees_nothing_behind_or_far_beside) {
  const camera::Optics optics{camera::CameraSettings{}};
  EXPECT_FALSE(optics.project(Vector3(0.1, 0.1, -1.0)));
  EXPECT_FALSE(optics.project(Vector3(1.0, 0.0, 0.0)));
  EXPECT_FALSE(optics.project(Vector3(3.0, 0.0, 1.0)));  // 71.6 deg
  EXPECT_FALSE(optics.project(Vector3::Zero()));
}

TEST(Optics, a_pixel_s_direction_falls_on_the_pixel) {
  const camera::Optics optics(distorted());
  for (double x = 0.0; x < 1920.0; x += 191.9)
    for (double y = 0.0; y < 1200.0; y += 119.9) {
      const Vector3 direction = optics.direction_of({x, y});
      EXPECT_NEAR(direction.norm(), 1.0, 1e-14);
      EXPECT_NEAR((*optics.project(direction) - Vector2(x, y)).norm(), 0.0, 1e-8);
    }
}

TEST(Optics, image_velocity_is_the_change_of_the_projection) {
  const camera::Optics optics(distorted());
  const Vector3 direction = Vector3(0.13, -0.08, 1.0).normalized();
  const Vector3 rate = direction.cross(Vector3(2e-3, -1e-3, 5e-3));
  const double dt = 1e-4;
  const Vector2 expected =
      (*optics.project(direction + dt * rate) - *optics.project(direction - dt * rate)) / (2.0 * dt);
  EXPECT_NEAR((optics.image_velocity(direction, rate) - expected).norm(), 0.0, 1e-6);
}

TEST(Optics, light_falls_towards_the_corners_as_the_radius_to_the_fourth) {
  const camera::Optics optics{camera::CameraSettings{}};
  EXPECT_DOUBLE_EQ(optics.vignetting({959.5, 599.5}), 1.0);
  EXPECT_NEAR(optics.vignetting({-0.5, -0.5}), 0.85, 1e-12);
  EXPECT_NEAR(optics.vignetting({959.5 + 480.0, 599.5 + 300.0}), 1.0 - 0.15 / 16.0, 1e-12);
}

TEST(Optics, the_cone_of_a_region_reaches_its_corners) {
  const camera::Optics optics{camera::CameraSettings{}};
  const camera::Cone cone = optics.cone_of({0, 0, 1920, 1200}, 0.0);
  EXPECT_NEAR((cone.axis - Vector3::UnitZ()).norm(), 0.0, 1e-12);
  EXPECT_NEAR(cone.half_angle, std::atan(std::hypot(960.0, 600.0) / (35e-3 / 5.86e-6)), 1e-12);
}

}  // namespace
