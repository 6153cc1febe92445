#pragma once
// From an image to the target's keypoints and pose (after SPN, Park and D'Amico 2023): detect the target, crop, run
// the network, evaluate its heatmaps, solve for the pose.

#include <optional>

#include "fsw/core/gps_time.h"
#include "fsw/vision/imaging/camera_model.h"
#include "fsw/vision/imaging/image.h"
#include "fsw/vision/pose/crop.h"
#include "fsw/vision/pose/keypoint.h"
#include "fsw/vision/pose/keypoint_network.h"
#include "fsw/vision/pose/pnp.h"
#include "fsw/vision/pose/target_finder.h"

namespace vbar::fsw::pose {

/// The camera as calibrated on the ground, and the target's shape.
struct PoseCameraSettings {
  imaging::ImageFrame frame;
  imaging::CameraModel model;
  double dark_level_dn = 64.0;  ///< level of a pixel without light
  double noise_dn = 2.0;        ///< 1 sigma of such a pixel
  int saturation_dn = 4000;
  KeypointShape shape{};
  PnpSettings pnp;
};

enum class SightingStatus : std::uint8_t {
  kPose = 0,       ///< keypoints and a pose
  kKeypointsOnly,  ///< keypoints (at least one usable), but no consistent pose
  kNoKeypoints,    ///< no keypoint detected
  kNoTarget,       ///< no object in the image can be the target
  kDark,           ///< no light but noise
  kBlinded,        ///< a larger part of the image is saturated than a target can saturate
  kInvalid,        ///< not the frame of the settings, or no network
};

struct PoseSighting {
  GpsTime time;
  std::int32_t image = 0;
  SightingStatus status = SightingStatus::kInvalid;
  bool region_is_predicted = false;  ///< the crop follows the prediction, not the image
  CropRegion region;                 ///< region of the crop
  Keypoints keypoints{};
  std::optional<PnpSolution> pnp;
};

/// Finds keypoints and pose of the target in an image. Nearly all of its 2 MB are the network.
class SpacecraftPoseNetwork {
 public:
  /// Replaces the settings; loads the weights on board if that is not done yet.
  void configure(const PoseCameraSettings& settings);

  /// Processes an image. `predicted` is the pose predicted by navigation, camera axes. Without a prediction, or if it
  /// is outside the image, the target is detected in the image alone, in two rounds: the second crops again around the
  /// result of the first. If the poses of the two contradict each other, neither is returned.
  const PoseSighting& process(GpsTime time, std::int32_t image_number, const imaging::ImageView& image,
                              const std::optional<Vector3>& predicted_position_camera_m);

  [[nodiscard]] const PoseSighting& sighting() const { return sighting_; }
  /// Network with its heatmaps of the last image.
  [[nodiscard]] const pose::KeypointNetwork& keypoint_network() const { return network_; }

 private:
  [[nodiscard]] SightingStatus look(const imaging::ImageView& image, const std::optional<Vector3>& predicted);
  [[nodiscard]] SightingStatus look_at(const imaging::ImageView& image, const CropRegion& region);
  [[nodiscard]] SightingStatus look_twice(const imaging::ImageView& image);
  [[nodiscard]] bool predict(const std::optional<Vector3>& predicted, CropRegion& region) const;
  [[nodiscard]] CropRegion second_region() const;

  PoseCameraSettings settings_;
  pose::KeypointNetwork network_;
  TargetFinder finder_;
  CropSamples crop_{};
  PoseSighting sighting_;
};

}  // namespace vbar::fsw::pose
