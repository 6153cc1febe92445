#pragma once
// Poses from keypoints without a start: SQPnP (Terzakis and Lourakis 2020). The squared distances of the points from
// their lines of sight, the position eliminated, are a quadratic form of the nine elements of the rotation. Starts are
// the rotations nearest to its lowest eigenvectors, with either sign; from each the form is minimised, here by Newton's
// method on the rotations themselves. Works for points in a plane.

#include <array>
#include <span>

#include "fsw/core/types.h"
#include "fsw/pose/pnp.h"

namespace vbar::fsw::pose {

/// A keypoint in the undistorted image plane at unit distance, and on the target (m).
struct SeenPoint {
  Vector2 image = Vector2::Zero();
  Vector3 body = Vector3::Zero();
  double weight = 1.0;
};

/// Its minima, lowest first, all points before the camera.
struct ClosedFormPoses {
  static constexpr std::size_t kMost = 4;
  std::array<TargetPose, kMost> poses{};
  std::array<double, kMost> costs{};
  std::size_t count = 0;
};

/// None of fewer than three points, of points on one line of sight, or not finite.
ClosedFormPoses closed_form_poses(std::span<const SeenPoint> points);

}  // namespace vbar::fsw::pose
