#include "hil_drivers/tron/kinematics/geometry.h"

namespace vbar::tron {

using fsw::Vector3;

Geometry::Geometry(const BenchFile& bench)
    : bench_(bench),
      T_L_track_base_(bench.camera_robot.base.T_L_base()),
      T_L_target_base_(bench.target_robot.base.T_L_base()),
      T_flange_C_(bench.camera.T_flange_camera()),
      T_flange_T_(bench.target.T_flange_target(bench.scale)) {}

Eigen::Isometry3d Geometry::T_L_camera_base(double carriage_m) const {
  return Eigen::Translation3d(carriage_m * Vector3::UnitX()) * T_L_track_base_;
}

Eigen::Isometry3d Geometry::T_L_C(const Posture& posture) const {
  return T_L_camera_base(posture.carriage_m) * T_base_flange(bench_.camera_robot.design, posture.camera_rad) *
         T_flange_C_;
}

Eigen::Isometry3d Geometry::T_L_T(const Posture& posture) const {
  return T_L_target_base_ * T_base_flange(bench_.target_robot.design, posture.target_rad) * T_flange_T_;
}

Eigen::Isometry3d Geometry::T_C_T(const Posture& posture) const {
  return T_L_C(posture).inverse() * T_L_T(posture);
}

Eigen::Isometry3d Geometry::camera_flange(const Eigen::Isometry3d& T_L_C, double carriage_m) const {
  return T_L_camera_base(carriage_m).inverse() * T_L_C * T_flange_C_.inverse();
}

Eigen::Isometry3d Geometry::target_flange(const Eigen::Isometry3d& T_L_T) const {
  return T_L_target_base_.inverse() * T_L_T * T_flange_T_.inverse();
}

std::optional<Posture> Geometry::with_relative_pose(const Posture& posture, const Eigen::Isometry3d& T_C_T,
                                                    double most_rad) const {
  const ArmDesign& arm = bench_.target_robot.design;
  std::optional<Posture> best;
  double best_rad = most_rad;
  for (const Branch& branch : inverse(arm, target_flange(T_L_C(posture) * T_C_T))) {
    const auto joints = within_limits(arm, branch.joints_rad, posture.target_rad);
    if (!joints) continue;
    const double moved_rad = (*joints - posture.target_rad).cwiseAbs().maxCoeff();
    if (moved_rad > best_rad) continue;
    best_rad = moved_rad;
    best = posture;
    best->target_rad = *joints;
  }
  return best;
}

}  // namespace vbar::tron
