#pragma once
// Pose that fits keypoints best on the distorted image, each weighted by its covariance: Gauss-Newton on the left
// perturbations of a pose, damped (Levenberg 1944, Marquardt 1963), with Huber's weights (1964). State: rotation about
// the camera's axes (rad) and position (m).

#include <span>

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/vision/imaging/camera_model.h"
#include "fsw/vision/pose/pnp.h"

namespace vbar::fsw::pose {

/// A keypoint on the detector and on the target (m).
struct Observation {
  Vector2 pixel = Vector2::Zero();
  Matrix2 whitening = Matrix2::Identity();  ///< factor that gives a residual in px unit covariance
  Vector3 body = Vector3::Zero();
};

/// Residuals beyond this number of sigma have a linear cost (Huber).
inline constexpr double kHuberSigmas = 3.0;

struct RefinedPose {
  TargetPose pose;
  double cost = 0.0;                      ///< half of the sum of whitened squares, with Huber's weights
  Matrix6 information = Matrix6::Zero();  ///< J'J of rotation (about the camera's axes, rad) and position (m)
};

/// Returns the predicted minus observed position of the keypoint, px. kOutOfRange if it is not in front of the camera.
Result<Vector2> miss_of(const Observation& observation, const TargetPose& pose, const imaging::CameraModel& camera);

/// Refines a pose with all points in front of the camera, else kOutOfRange. kSingular if the points leave the pose
/// open.
Result<RefinedPose> refine_pose(std::span<const Observation> observations, const imaging::CameraModel& camera,
                                const TargetPose& start);

}  // namespace vbar::fsw::pose
