#pragma once
// A camera as calibrated on the ground, from its telecommand.

#include <cstddef>
#include <optional>

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/messaging/telecommands.h"
#include "fsw/packets/messages.h"
#include "fsw/vision/imaging/camera_model.h"
#include "fsw/vision/imaging/image.h"

namespace vbar::fsw::measurements {

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

// Which source an image feeds. A camera whose images serve for bearings and for keypoints takes them with two
// exposures: long for stars, short for a resolved target. The exposure of an image then states what it was taken for.

/// Exposures of a camera with both uses, s.
struct TwoExposures {
  double bearings_s = 0.0;
  double keypoints_s = 0.0;

  [[nodiscard]] bool is_for_keypoints(double exposure_s) const {
    return exposure_s * exposure_s < bearings_s * keypoints_s;
  }
};

/// They must differ by this factor, so that no image is ambiguous.
inline constexpr double kMinExposureRatio = 4.0;

/// kOutOfRange if they are not stated, or too similar.
[[nodiscard]] inline Result<TwoExposures> two_exposures(const angles_only_configuration& bearings,
                                                        const pose_configuration& keypoints) {
  const bool is_usable = keypoints.exposure_s > 0.0 && bearings.exposure_s >= kMinExposureRatio * keypoints.exposure_s;
  if (!is_usable) return Status::kOutOfRange;
  return TwoExposures{bearings.exposure_s, keypoints.exposure_s};
}

/// Empty for a camera with one use, or none.
[[nodiscard]] inline std::optional<TwoExposures> two_exposures(const messaging::Telecommands& telecommands,
                                                               std::size_t unit) {
  const auto* bearings = telecommands.in_force<angles_only_configuration>(unit);
  const auto* keypoints = telecommands.in_force<pose_configuration>(unit);
  if (bearings == nullptr || keypoints == nullptr) return std::nullopt;
  const Result<TwoExposures> both = two_exposures(*bearings, *keypoints);
  return both.ok() ? std::optional(both.value()) : std::nullopt;
}

}  // namespace vbar::fsw::measurements
