#pragma once
// Measurements of a calibration at a posture of the testbed.

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "hil_drivers/tron/kinematics/posture.h"

namespace vbar::tron::calibrate {

/// Holds a corner of the board in an image.
struct Corner {
  int id = 0;  ///< BoardDesign::corner()
  fsw::Vector2 px = fsw::Vector2::Zero();
};

/// Holds the poses of the objects of motion capture, averaged at rest; rotations by the order of the bench file.
struct ViconObjects {
  Eigen::Isometry3d T_V_camera = Eigen::Isometry3d::Identity(), T_V_target = Eigen::Isometry3d::Identity();
};

struct Measurement {
  Posture posture;  ///< as the controllers state it, at rest
  std::vector<Corner> corners;
  std::optional<ViconObjects> vicon;
  /// True relative pose of the target's frame, from an emulator. A fit never uses it.
  std::optional<Eigen::Isometry3d> true_T_C_T;
};

/// Returns the pose whose three angles, which were taken as rotations in the order `from`, are in the order `to`
/// ("xyz": Rx Ry Rz).
[[nodiscard]] Eigen::Isometry3d reordered(const Eigen::Isometry3d& pose, const std::string& from,
                                          const std::string& to);

}  // namespace vbar::tron::calibrate
