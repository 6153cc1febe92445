#pragma once
// From an image to the target's keypoints and pose (after SPN, Park and D'Amico 2023): find the target, cut it out, run
// the network, read its maps, solve for the pose.

#include <optional>

#include "fsw/core/gps_time.h"
#include "fsw/imaging/camera_model.h"
#include "fsw/imaging/image.h"
#include "fsw/network/keypoint_network.h"
#include "fsw/pose/crop.h"
#include "fsw/pose/keypoint.h"
#include "fsw/pose/pnp.h"

namespace vbar::fsw::pose {

/// The camera as calibrated on the ground, and the target's shape.
struct PoseCameraSettings {
  imaging::ImageFrame frame;
  imaging::CameraModel model;
  double dark_level_dn = 64.0;  ///< of a pixel without light
  double noise_dn = 2.0;        ///< 1 sigma of such a pixel
  int saturation_dn = 4000;
  KeypointShape shape{};
  PnpSettings pnp;
};

enum class SightingStatus : std::uint8_t {
  kPose = 0,     ///< keypoints and a pose
  kKeypoints,    ///< keypoints (at least one usable), but no pose that they agree on
  kNoKeypoints,  ///< the network saw none
  kNoTarget,     ///< nothing in the image that could be the target
  kDark,         ///< no light but noise
  kBlinded,      ///< more of the image saturated than a target can
  kInvalid,      ///< not the frame of the settings, or no network
};

struct PoseSighting {
  GpsTime time;
  std::int32_t image = 0;
  SightingStatus status = SightingStatus::kInvalid;
  bool region_is_predicted = false;  ///< the crop follows the prediction, not the image
  CropRegion region;                 ///< of the crop
  Keypoints keypoints{};
  std::optional<PnpSolution> pnp;
};

class SpacecraftPoseNetwork {
 public:
  /// Replaces the settings; loads the weights on board if that is not done yet.
  void configure(const PoseCameraSettings& settings);

  /// `predicted`: where navigation expects the target, camera axes. Without it the target is found in the image alone,
  /// in two rounds: the second cuts out anew what the first made of it.
  const PoseSighting& process(GpsTime time, std::int32_t image_number, const imaging::ImageView& image,
                              const std::optional<Vector3>& predicted_position_camera_m);

  [[nodiscard]] const PoseSighting& sighting() const;
  [[nodiscard]] const network::KeypointNetwork& keypoint_network() const;  ///< its maps of the last image
};

/// The crop for a target there: the square around all its keypoints, however it is turned. kOutOfRange if behind.
Result<CropRegion> region_of(const Vector3& position_camera_m, const imaging::CameraModel& model,
                             const KeypointShape& shape);

}  // namespace vbar::fsw::pose
