#pragma once
// Both arms, the track and the mounts of a testbed, as designed.

#include <optional>

#include <Eigen/Geometry>

#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/kinematics/arm.h"
#include "hil_drivers/tron/kinematics/posture.h"

namespace vbar::tron {

class ArmPair {
 public:
  explicit ArmPair(const BenchFile& bench);

  [[nodiscard]] const Arm& camera_arm() const { return camera_arm_; }
  [[nodiscard]] const Arm& target_arm() const { return target_arm_; }

  /// Returns the base of the camera's arm with the carriage at `carriage_m`.
  [[nodiscard]] Eigen::Isometry3d T_L_camera_base(double carriage_m) const;
  [[nodiscard]] const Eigen::Isometry3d& T_L_target_base() const { return T_L_target_base_; }
  [[nodiscard]] const Eigen::Isometry3d& T_flange_camera() const { return T_flange_camera_; }
  [[nodiscard]] const Eigen::Isometry3d& T_flange_target() const { return T_flange_target_; }

  /// Return T_L_C, T_L_T, T_C_T.
  [[nodiscard]] Eigen::Isometry3d camera_pose(const Posture& posture) const;
  [[nodiscard]] Eigen::Isometry3d target_pose(const Posture& posture) const;
  [[nodiscard]] Eigen::Isometry3d T_C_T(const Posture& posture) const;

  /// Return T_base_flange of each arm for a pose in the laboratory.
  [[nodiscard]] Eigen::Isometry3d camera_flange(const Eigen::Isometry3d& T_L_C, double carriage_m) const;
  [[nodiscard]] Eigen::Isometry3d target_flange(const Eigen::Isometry3d& T_L_T) const;

  /// Returns a posture near `posture`, where T_C_T was measured, at which it is `wanted` if the error of the chain is
  /// the same there. One arm moves, the one that is farther from a singularity. Newton's method with the Jacobian as
  /// designed; nothing if it does not converge, leaves the limits, or a pose is not finite.
  [[nodiscard]] std::optional<Posture> correct(const Posture& posture, const Eigen::Isometry3d& measured_T_C_T,
                                               const Eigen::Isometry3d& wanted_T_C_T) const;

 private:
  Arm camera_arm_, target_arm_;
  Eigen::Isometry3d T_L_carriage_base_, T_L_target_base_, T_flange_camera_, T_flange_target_;
};

}  // namespace vbar::tron
