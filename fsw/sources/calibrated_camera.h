#pragma once
// A camera as calibrated on the ground, from its telecommand.

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/imaging/camera_model.h"
#include "fsw/imaging/image.h"
#include "fsw/packets/messages.h"

namespace vbar::fsw::sources {

struct CalibratedCamera {
  imaging::ImageFrame frame;
  imaging::CameraModel model;
  Matrix3 R_camera_body = Matrix3::Identity();
  Vector3 position_body_m = Vector3::Zero();
  int saturation_dn = 0;
};

/// kOutOfRange for a value outside its valid range.
Result<CalibratedCamera> calibrated_camera(const camera_configuration& camera);
[[nodiscard]] bool is_valid(const camera_configuration& camera);

}  // namespace vbar::fsw::sources
