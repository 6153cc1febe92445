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
#include "fsw/pose/region.h"
#include "fsw/pose/target_finder.h"

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

/// Some 2 MB, nearly all of it the network's.
class SpacecraftPoseNetwork {
 public:
  /// Replaces the settings; loads the weights on board if that is not done yet.
  void configure(const PoseCameraSettings& settings);

  /// `predicted`: where navigation expects the target, camera axes. Without it, or where the image cannot hold what it
  /// says, the target is found in the image alone, in two rounds: the second cuts out anew what the first made of it.
  /// Poses of the two that contradict each other are none.
  const PoseSighting& process(GpsTime time, std::int32_t image_number, const imaging::ImageView& image,
                              const std::optional<Vector3>& predicted_position_camera_m);

  [[nodiscard]] const PoseSighting& sighting() const { return sighting_; }
  /// Its maps of the last image.
  [[nodiscard]] const network::KeypointNetwork& keypoint_network() const { return network_; }

 private:
  [[nodiscard]] SightingStatus look(const imaging::ImageView& image, const std::optional<Vector3>& predicted);
  [[nodiscard]] SightingStatus look_at(const imaging::ImageView& image, const CropRegion& region);
  [[nodiscard]] SightingStatus look_twice(const imaging::ImageView& image);
  [[nodiscard]] bool predict(const std::optional<Vector3>& predicted, CropRegion& region) const;
  [[nodiscard]] CropRegion second_region() const;

  PoseCameraSettings settings_;
  network::KeypointNetwork network_;
  TargetFinder finder_;
  CropSamples crop_{};
  PoseSighting sighting_;
};

}  // namespace vbar::fsw::pose
