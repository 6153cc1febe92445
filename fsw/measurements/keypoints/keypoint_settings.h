#pragma once
// The telecommands of keypoints, validated and converted to settings.

#include "fsw/core/result.h"
#include "fsw/filter/target_attitude.h"
#include "fsw/measurements/keypoints/keypoint_aiding.h"
#include "fsw/packets/messages.h"
#include "fsw/vision/pose/spacecraft_pose_network.h"

namespace vbar::fsw::measurements {

[[nodiscard]] bool is_valid(const pose_configuration& configuration);
/// An inertia of a rigid body, and keypoints that are neither nearly coincident nor collinear.
[[nodiscard]] bool is_valid(const target_model& model);

/// Returns the settings of one camera.
struct KeypointCameraSettings {
  pose::PoseCameraSettings network;
  KeypointCamera camera;
  Matrix3 R_camera_body = Matrix3::Identity();
  double sigma_scale = 1.0;  ///< factor on the network's standard deviations: other illumination than in its training
  double sigma_floor_px = 0.0;  ///< and a standard deviation added to them
};

/// kOutOfRange for an invalid telecommand, here and below.
Result<pose::PoseCameraSettings> pose_camera_settings(const camera_configuration& camera, const target_model& target);
/// `unit`: of the camera.
Result<KeypointCameraSettings> keypoint_camera_settings(std::size_t unit, const camera_configuration& camera,
                                                        const target_model& target,
                                                        const pose_configuration& configuration);
/// Initialisation as configured for one camera.
Result<KeypointAidingSettings> keypoint_aiding_settings(const target_model& target,
                                                        const pose_configuration& configuration);
Result<filter::TargetAttitudeSettings> attitude_settings(const target_model& target);

}  // namespace vbar::fsw::measurements
