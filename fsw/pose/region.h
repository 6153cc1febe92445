#pragma once
// Which square of the detector to cut out.

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/imaging/camera_model.h"
#include "fsw/pose/crop.h"
#include "fsw/pose/keypoint.h"

namespace vbar::fsw::pose {

/// The crop for a target there: the square around all its keypoints, however it is turned. kOutOfRange if behind.
Result<CropRegion> region_of(const Vector3& position_camera_m, const imaging::CameraModel& model,
                             const KeypointShape& shape);

}  // namespace vbar::fsw::pose
