#pragma once
// The square of the detector to crop.

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/imaging/camera_model.h"
#include "fsw/pose/crop.h"
#include "fsw/pose/keypoint.h"

namespace vbar::fsw::pose {

/// Side of a crop in apparent radii of the target: the mean of the training data.
inline constexpr double kCropRadii = 2.3;

/// Returns the radius of the sphere about the origin that holds all keypoints, m.
[[nodiscard]] double radius_of(const KeypointShape& shape);

/// Returns the crop for a target at a pose: the square around all its keypoints, for any attitude. kOutOfRange if
/// behind.
Result<CropRegion> region_of(const Vector3& position_camera_m, const imaging::CameraModel& model,
                             const KeypointShape& shape);

}  // namespace vbar::fsw::pose
