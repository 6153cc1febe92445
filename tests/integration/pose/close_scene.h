#pragma once
// Whole images of experiment 2's camera twin, and what the flight software makes of them with the weights on board.

#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "fsw/vision/pose/spacecraft_pose_network.h"
#include "host_sim/training/circumstances.h"
#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/detector.h"
#include "host_sim/twins/camera/scene.h"

namespace vbar::test {

/// What is before the camera, in its axes: z boresight, x right, y down. As it stands: the target eight metres ahead in
/// the middle, the Sun from behind the camera on the right, the Earth below and out of the field.
struct CloseView {
  fsw::pose::TargetPose pose{fsw::Matrix3::Identity(), fsw::Vector3(0.0, 0.0, 8.0)};
  fsw::Vector3 sun = fsw::Vector3(0.7, -0.2, -0.7).normalized();
  fsw::Vector3 nadir = fsw::Vector3(0.0, 1.0, -0.35).normalized();
  double sunlit = 1.0;
  double exposure = 1.0;  ///< times the mission's
  bool has_target = true;
  bool is_other = false;  ///< a ball of the target's size instead
};

/// Angle, rad, Sun to camera as the target sees it, the Sun turned about the line of sight by `turn`.
fsw::Vector3 sun_at_phase(const fsw::pose::TargetPose& pose, double phase, double turn);

/// Of the image's pose against the truth.
struct PoseMiss {
  double attitude_deg = 0.0;
  double position_share = 0.0;  ///< of the distance
};
PoseMiss miss_of(const fsw::pose::PnpSolution& found, const fsw::pose::TargetPose& truth);

class CloseScene {
 public:
  CloseScene();

  /// Pixels of the region that is read.
  const std::vector<std::uint16_t>& take(const CloseView& view);
  /// The flight software's answer to that image; `predicted`: as navigation would, or none.
  const fsw::pose::PoseSighting& look(const CloseView& view, const std::optional<fsw::Vector3>& predicted);

  [[nodiscard]] const twins::camera::CameraSettings& camera() const { return camera_; }

 private:
  twins::camera::CameraSettings camera_;
  training::TargetShape shape_;
  fsw::pose::PoseCameraSettings settings_;
  std::unique_ptr<fsw::pose::SpacecraftPoseNetwork> network_;
  std::unique_ptr<twins::camera::SceneRenderer> target_, other_;
  std::unique_ptr<twins::camera::Detector> detector_;
  twins::camera::PhotonImage photons_;
  std::vector<std::uint16_t> dn_;
  std::int32_t image_ = 0;
};

}  // namespace vbar::test
