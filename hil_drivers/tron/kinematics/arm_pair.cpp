#include "hil_drivers/tron/kinematics/arm_pair.h"

#include <cmath>

#include <Eigen/LU>
#include <Eigen/SVD>

namespace vbar::tron {
namespace {

using fsw::Vector3;

constexpr int kNewtonSteps = 12;
constexpr double kConverged = 1e-12;  ///< m and rad
/// The largest step of an axis in one iteration; corrections are smaller by far.
constexpr double kLargestStep_rad = 0.2;

double smallest_singular_value(const Arm& arm, const Joints& joints) {
  return arm.jacobian(joints).jacobiSvd().singularValues()[5];
}

/// The joints near `from` at which the flange is at `wanted`.
std::optional<Joints> solve(const Arm& arm, const Joints& from, const Eigen::Isometry3d& wanted) {
  Joints q = from;
  for (int k = 0; k < kNewtonSteps; ++k) {
    const Eigen::Isometry3d at = arm.forward(q);
    const Eigen::AngleAxisd turn(wanted.linear() * at.linear().transpose());
    Eigen::Matrix<double, 6, 1> error;
    error << wanted.translation() - at.translation(), turn.angle() * turn.axis();
    if (!error.allFinite()) return std::nullopt;
    if (error.norm() < kConverged) return arm.is_within_limits(q) ? std::optional(q) : std::nullopt;
    Joints step = arm.jacobian(q).partialPivLu().solve(error);
    const double largest = step.lpNorm<Eigen::Infinity>();
    if (!std::isfinite(largest)) return std::nullopt;
    if (largest > kLargestStep_rad) step *= kLargestStep_rad / largest;
    q += step;
  }
  return std::nullopt;
}

}  // namespace

ArmPair::ArmPair(const BenchFile& bench)
    : camera_arm_(bench.camera_robot.design),
      target_arm_(bench.target_robot.design),
      T_L_carriage_base_(bench.camera_robot.base.T_L_base()),
      T_L_target_base_(bench.target_robot.base.T_L_base()),
      T_flange_camera_(bench.camera.T_flange_camera()),
      T_flange_target_(bench.target.T_flange_target(bench.scale)) {}

Eigen::Isometry3d ArmPair::T_L_camera_base(double carriage_m) const {
  Eigen::Isometry3d T = T_L_carriage_base_;
  T.translation().x() += carriage_m;
  return T;
}

Eigen::Isometry3d ArmPair::camera_pose(const Posture& posture) const {
  return T_L_camera_base(posture.carriage_m) * camera_arm_.forward(posture.camera_rad) * T_flange_camera_;
}

Eigen::Isometry3d ArmPair::target_pose(const Posture& posture) const {
  return T_L_target_base_ * target_arm_.forward(posture.target_rad) * T_flange_target_;
}

Eigen::Isometry3d ArmPair::T_C_T(const Posture& posture) const {
  return camera_pose(posture).inverse() * target_pose(posture);
}

Eigen::Isometry3d ArmPair::camera_flange(const Eigen::Isometry3d& T_L_C, double carriage_m) const {
  return T_L_camera_base(carriage_m).inverse() * T_L_C * T_flange_camera_.inverse();
}

Eigen::Isometry3d ArmPair::target_flange(const Eigen::Isometry3d& T_L_T) const {
  return T_L_target_base_.inverse() * T_L_T * T_flange_target_.inverse();
}

std::optional<Posture> ArmPair::correct(const Posture& posture, const Eigen::Isometry3d& measured,
                                        const Eigen::Isometry3d& wanted) const {
  if (!measured.matrix().allFinite() || !wanted.matrix().allFinite() || !posture.camera_rad.allFinite() ||
      !posture.target_rad.allFinite() || !std::isfinite(posture.carriage_m))
    return std::nullopt;
  // The motion that the pose lacks, in the camera's axes and in the target's.
  const Eigen::Isometry3d T_C_Cnew = measured * wanted.inverse();
  const Eigen::Isometry3d T_T_Tnew = measured.inverse() * wanted;
  const auto by_camera = [&]() -> std::optional<Posture> {
    const Eigen::Isometry3d flange =
        camera_arm_.forward(posture.camera_rad) * T_flange_camera_ * T_C_Cnew * T_flange_camera_.inverse();
    const auto joints = solve(camera_arm_, posture.camera_rad, flange);
    return joints ? std::optional(Posture{*joints, posture.target_rad, posture.carriage_m}) : std::nullopt;
  };
  const auto by_target = [&]() -> std::optional<Posture> {
    const Eigen::Isometry3d flange =
        target_arm_.forward(posture.target_rad) * T_flange_target_ * T_T_Tnew * T_flange_target_.inverse();
    const auto joints = solve(target_arm_, posture.target_rad, flange);
    return joints ? std::optional(Posture{posture.camera_rad, *joints, posture.carriage_m}) : std::nullopt;
  };
  const bool is_camera_better = smallest_singular_value(camera_arm_, posture.camera_rad) >=
                                smallest_singular_value(target_arm_, posture.target_rad);
  if (is_camera_better) {
    const auto found = by_camera();
    return found ? found : by_target();
  }
  const auto found = by_target();
  return found ? found : by_camera();
}

}  // namespace vbar::tron
