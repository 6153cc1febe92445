#pragma once
// Poses from keypoints without initial value: SQPnP (Terzakis and Lourakis 2020). The squared distances of the points
// from their lines of sight, the position eliminated, are a quadratic form in the nine elements of the rotation. The
// start values are the rotations nearest to its lowest eigenvectors, with either sign; from each it is minimised, by
// Newton's method on the rotations themselves. Works for coplanar points.

#include <array>
#include <span>

#include "fsw/core/types.h"
#include "fsw/vision/pose/pnp.h"

namespace vbar::fsw::pose {

/// A keypoint in the undistorted image plane at unit distance, and on the target (m).
struct SeenPoint {
  Vector2 image = Vector2::Zero();
  Vector3 body = Vector3::Zero();
  double weight = 1.0;
};

/// Minima of the quadratic form, lowest first, all points in front of the camera.
struct ClosedFormPoses {
  static constexpr std::size_t kMaxPoses = 4;
  std::array<TargetPose, kMaxPoses> poses{};
  std::array<double, kMaxPoses> costs{};
  std::size_t count = 0;
};

/// Returns the poses; none for fewer than three points, points on one line of sight, or values that are not finite.
ClosedFormPoses closed_form_poses(std::span<const SeenPoint> points);

}  // namespace vbar::fsw::pose
