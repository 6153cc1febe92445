#pragma once
// Mapping between pixels and directions. Camera axes: z boresight, x right, y down in the image; pixel coordinates are
// those of the detector, and an integer is the centre of a pixel.

#include <array>

#include "fsw/core/result.h"
#include "fsw/core/types.h"

namespace vbar::fsw::imaging {

/// Pinhole with Brown-Conrady distortion (Brown 1966; coefficients in the order k1, k2, p1, p2, k3).
struct CameraModel {
  Vector2 focal_length_px = Vector2::Zero();
  Vector2 principal_point_px = Vector2::Zero();
  std::array<double, 5> distortion{};
};

/// Returns the unit vector in camera axes. kDidNotConverge where the distortion cannot be inverted.
Result<Vector3> direction_of(const CameraModel& camera, const Vector2& pixel);

/// Returns the pixel of a direction. kOutOfRange for directions not in front of the camera (z <= 0.1 of the norm).
Result<Vector2> pixel_of(const CameraModel& camera, const Vector3& direction_camera);

/// Projection of a point in camera axes (m), and the Jacobian of its pixel.
struct Projection {
  Vector2 pixel = Vector2::Zero();
  Eigen::Matrix<double, 2, 3> derivative = Eigen::Matrix<double, 2, 3>::Zero();  ///< px / m
};
Result<Projection> project(const CameraModel& camera, const Vector3& point_camera_m);

}  // namespace vbar::fsw::imaging
