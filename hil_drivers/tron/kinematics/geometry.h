#pragma once
// Where camera and target are in the laboratory at a posture, by the bench as designed.

#include <optional>

#include <Eigen/Geometry>

#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/kinematics/arm.h"

namespace vbar::tron {

class Geometry {
 public:
  explicit Geometry(const BenchFile& bench);

  [[nodiscard]] const BenchFile& bench() const { return bench_; }

  /// Base of the camera's arm with the carriage there.
  [[nodiscard]] Eigen::Isometry3d T_L_camera_base(double carriage_m) const;
  [[nodiscard]] const Eigen::Isometry3d& T_L_target_base() const { return T_L_target_base_; }

  [[nodiscard]] Eigen::Isometry3d T_L_C(const Posture& posture) const;
  [[nodiscard]] Eigen::Isometry3d T_L_T(const Posture& posture) const;
  [[nodiscard]] Eigen::Isometry3d T_C_T(const Posture& posture) const;

  /// Flange of the camera's arm in its base, and of the target's arm, for a pose in the laboratory.
  [[nodiscard]] Eigen::Isometry3d camera_flange(const Eigen::Isometry3d& T_L_C, double carriage_m) const;
  [[nodiscard]] Eigen::Isometry3d target_flange(const Eigen::Isometry3d& T_L_T) const;

  /// The posture with the target's arm moved so that the relative pose is `T_C_T`, on the branch nearest to where it
  /// stands; nothing if it is out of reach, beyond a limit, or more than `most_rad` away in an axis.
  [[nodiscard]] std::optional<Posture> with_relative_pose(const Posture& posture, const Eigen::Isometry3d& T_C_T,
                                                          double most_rad = 0.35) const;

 private:
  BenchFile bench_;
  Eigen::Isometry3d T_L_track_base_, T_L_target_base_, T_flange_C_, T_flange_T_;
};

}  // namespace vbar::tron
