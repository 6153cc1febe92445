#pragma once
// The pose of the target from keypoints of one image (perspective n points).

#include <cstdint>

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/vision/imaging/camera_model.h"
#include "fsw/vision/pose/keypoint.h"

namespace vbar::fsw::pose {

/// Pose of the target with respect to the camera.
struct TargetPose {
  Matrix3 R_camera_body = Matrix3::Identity();
  Vector3 position_camera_m = Vector3::UnitZ();  ///< position of its centre of mass
};

struct PnpSolution {
  TargetPose pose;
  /// Covariance of a small rotation about the camera's axes (rad, R_true = exp(rotation) R) and of the position (m).
  Matrix6 covariance = Matrix6::Zero();
  std::array<bool, pose::kKeypoints> is_inlier{};
  int inliers = 0;
  double mean_square = 0.0;  ///< mean square of whitened inlier residuals: 1 if the covariances are correct
};

struct PnpSettings {
  double inlier_sigmas = 3.0;
  double inlier_floor_px = 2.0;  ///< a residual below this is that of an inlier, however small its covariance
  int min_inliers = 6;
  double max_mean_square = 1e9;  ///< largest PnpSolution::mean_square: solutions with a worse fit are rejected
  double nearest_m = 1.0;
  double farthest_m = 100.0;
};

/// Solves for the pose by the usable keypoints: random minimal sets (RANSAC; the sets follow from `seed`), a closed
/// form (SQPnP), and a Gauss-Newton refinement of all inliers whitened by their covariances, with Huber weights.
/// kNotReady with too few usable keypoints, kDidNotConverge if no pose has enough inliers or they fit badly,
/// kOutOfRange for a pose outside the settings' distances.
Result<PnpSolution> solve_pnp(const Keypoints& keypoints, const KeypointShape& shape,
                              const imaging::CameraModel& camera, const PnpSettings& settings, std::uint32_t seed);

}  // namespace vbar::fsw::pose
