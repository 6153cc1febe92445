// The pinhole by hand, Brown's distortion term by term, and there and back.

#include "fsw/vision/imaging/camera_model.h"

#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace vbar::fsw::imaging {
namespace {

CameraModel reference() {
  return {.focal_length_px = {5972.7, 5972.7}, .principal_point_px = {959.5, 599.5}};
}

TEST(CameraModel, APinholeByHand) {
  const CameraModel camera = reference();
  // 4 : 3 : 12 right, down and forward make a norm of 13
  const Vector2 pixel = pixel_of(camera, Vector3(4.0, 3.0, 12.0)).value();
  EXPECT_NEAR(pixel.x(), 959.5 + 5972.7 / 3.0, 1e-9);
  EXPECT_NEAR(pixel.y(), 599.5 + 5972.7 / 4.0, 1e-9);
  const Vector3 direction = direction_of(camera, pixel).value();
  EXPECT_NEAR(direction.x(), 4.0 / 13.0, 1e-15);
  EXPECT_NEAR(direction.y(), 3.0 / 13.0, 1e-15);
  EXPECT_NEAR(direction.z(), 12.0 / 13.0, 1e-15);
}

TEST(CameraModel, APixelOfTheReferenceCameraIs34Point53ArcsecWide) {
  const Vector3 a = direction_of(reference(), {959.5, 599.5}).value();
  const Vector3 b = direction_of(reference(), {960.5, 599.5}).value();
  EXPECT_NEAR(a.cross(b).norm() * 206264.806, 34.534, 0.001);
}

/// x = 0.2, y = 0.1, r^2 = 0.05, each coefficient alone (Brown 1966 in OpenCV's order).
TEST(CameraModel, DistortionTermByTerm) {
  const std::array<Vector2, 5> expected{
      Vector2(0.2 * 0.05, 0.1 * 0.05),              // k1 r^2
      Vector2(0.2 * 0.0025, 0.1 * 0.0025),          // k2 r^4
      Vector2(2.0 * 0.2 * 0.1, 0.05 + 2.0 * 0.01),  // p1
      Vector2(0.05 + 2.0 * 0.04, 2.0 * 0.2 * 0.1),  // p2
      Vector2(0.2 * 0.000125, 0.1 * 0.000125),      // k3 r^6
  };
  for (std::size_t k = 0; k < 5; ++k) {
    CameraModel camera{.focal_length_px = {1000.0, 2000.0}, .principal_point_px = {10.0, 20.0}};
    camera.distortion[k] = 0.01;
    const Vector2 pixel = pixel_of(camera, Vector3(0.2, 0.1, 1.0)).value();
    EXPECT_NEAR(pixel.x(), 10.0 + 1000.0 * (0.2 + 0.01 * expected[k].x()), 1e-10) << k;
    EXPECT_NEAR(pixel.y(), 20.0 + 2000.0 * (0.1 + 0.01 * expected[k].y()), 1e-10) << k;
  }
}

TEST(CameraModel, ThereAndBackOverTheWholeDetector) {
  CameraModel camera = reference();
  camera.distortion = {-0.12, 0.3, 0.001, -0.0015, 0.2};
  for (int y = 0; y < 1200; y += 60) {
    for (int x = 0; x < 1920; x += 60) {
      const Vector2 pixel(x, y);
      const Result<Vector3> direction = direction_of(camera, pixel);
      ASSERT_TRUE(direction.ok());
      EXPECT_NEAR(direction.value().norm(), 1.0, 1e-15);
      EXPECT_LT((pixel_of(camera, direction.value()).value() - pixel).norm(), 1e-9);
    }
  }
}

TEST(CameraModel, RefusesWhatItCannotSee) {
  const CameraModel camera = reference();
  EXPECT_EQ(pixel_of(camera, Vector3(0.0, 0.0, -1.0)).status(), Status::kOutOfRange);
  EXPECT_EQ(pixel_of(camera, Vector3(1.0, 0.0, 0.0)).status(), Status::kOutOfRange);
  EXPECT_EQ(pixel_of(camera, Vector3(1.0, 0.0, 0.1)).status(), Status::kOutOfRange);
  EXPECT_EQ(pixel_of(camera, Vector3::Zero()).status(), Status::kOutOfRange);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(pixel_of(camera, Vector3(0.0, kNan, 1.0)).status(), Status::kNotFinite);
  EXPECT_EQ(direction_of(camera, Vector2(kNan, 0.0)).status(), Status::kNotFinite);
  EXPECT_EQ(direction_of(CameraModel{}, Vector2(1.0, 1.0)).status(), Status::kInvalidArgument);
  EXPECT_EQ(pixel_of(CameraModel{}, Vector3::UnitZ()).status(), Status::kInvalidArgument);
}

/// r (1 - 0.5 r^2) is 0.544 at most: no direction is seen beyond.
TEST(CameraModel, ADistortionThatFoldsHasNoInverse) {
  CameraModel camera{.focal_length_px = {1000.0, 1000.0}, .principal_point_px = {0.0, 0.0}};
  camera.distortion[0] = -0.5;
  EXPECT_TRUE(direction_of(camera, Vector2(500.0, 0.0)).ok());
  EXPECT_EQ(direction_of(camera, Vector2(560.0, 0.0)).status(), Status::kDidNotConverge);
  EXPECT_EQ(direction_of(camera, Vector2(5000.0, 5000.0)).status(), Status::kDidNotConverge);
}

}  // namespace
}  // namespace vbar::fsw::imaging
