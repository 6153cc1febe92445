#pragma once
// Telecommands of cameras and of camera-based navigation, validated and converted to settings. kOutOfRange for a value
// outside its valid range, or for telecommands that contradict each other.

#include <optional>

#include "fsw/angles_only/angles_only_tracking.h"
#include "fsw/core/result.h"
#include "fsw/packets/messages.h"
#include "fsw/pose/spacecraft_pose_network.h"
#include "fsw/sources/bearings/bearing_aiding.h"
#include "fsw/sources/keypoints/keypoint_source.h"

namespace vbar::fsw::gnc {

/// Whether the values of a telecommand are within their valid ranges, irrespective of all other telecommands.
[[nodiscard]] bool is_valid(const camera_configuration& camera);
[[nodiscard]] bool is_valid(const angles_only_configuration& configuration);
[[nodiscard]] bool is_valid(const pose_configuration& configuration);
/// Whether a valid camera and a valid model of the target may be used together: a pixel without light is not saturated.
[[nodiscard]] bool agree(const camera_configuration& camera, const pose_configuration& configuration);

/// A camera as calibrated on the ground.
struct CalibratedCamera {
  imaging::ImageFrame frame;
  imaging::CameraModel model;
  Matrix3 R_camera_body = Matrix3::Identity();
  Vector3 position_body_m = Vector3::Zero();
  int saturation_dn = 0;
};
Result<CalibratedCamera> calibrated_camera(const camera_configuration& camera);

Result<angles_only::CameraSettings> camera_settings(const camera_configuration& camera,
                                                    const angles_only_configuration& angles_only);
/// Navigation by bearings: the source, and the blocks of the trunk that it tunes.
struct BearingNavigationSettings {
  sources::BearingSettings bearings;
  trunk::TrunkSettings blocks;
};
Result<BearingNavigationSettings> bearing_settings(const angles_only_configuration& configuration);

Result<pose::PoseCameraSettings> pose_camera_settings(const camera_configuration& camera,
                                                      const pose_configuration& configuration);
/// Navigation by keypoints: the source, the blocks of the trunk that it tunes, and the orbit from preceding navigation.
struct KeypointNavigationSettings {
  sources::KeypointSettings keypoints;
  trunk::TrunkSettings blocks;
  std::optional<trunk::TargetApriori> apriori;  ///< empty: initialisation from images alone
};
Result<KeypointNavigationSettings> keypoint_settings(const camera_configuration& camera,
                                                     const pose_configuration& configuration);

}  // namespace vbar::fsw::gnc
