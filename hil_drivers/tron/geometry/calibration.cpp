#include "hil_drivers/tron/geometry/calibration.h"

#include <algorithm>
#include <cmath>

namespace vbar::tron {
namespace {

constexpr double kTrackStep_m = 0.5;

/// +1 where the base's z points up, -1 where it points down.
double gravity_sense(const Eigen::Isometry3d& T_L_base) {
  return T_L_base.linear()(2, 2) >= 0.0 ? 1.0 : -1.0;
}

Eigen::Isometry3d T_base_flange_of(const ArmCalibration& arm, const Joints& joints_rad) {
  const Eigen::Isometry3d T_base = arm.base.isometry();
  return T_base *
         T_base_flange<double>(arm.lengths, joints_rad.data(), gravity_sense(T_base),
                               {arm.offset_rad.data(), arm.link.front().data(), arm.flex_rad_m.data()}) *
         arm.mount.isometry();
}

ArmCalibration arm_as_designed(const Robot& robot, const Eigen::Isometry3d& mount) {
  ArmCalibration arm;
  arm.lengths = ArmLengths::of(robot.design);
  arm.base = PoseFigures::of(robot.base.T_L_base());
  arm.mount = PoseFigures::of(mount);
  return arm;
}

}  // namespace

Eigen::Isometry3d PoseFigures::isometry() const {
  const std::array<double, 6> six{rotation_rad[0],  rotation_rad[1],  rotation_rad[2],
                                  translation_m[0], translation_m[1], translation_m[2]};
  return rigid_of(six.data());
}

PoseFigures PoseFigures::of(const Eigen::Isometry3d& pose) {
  const Eigen::AngleAxisd turn(pose.linear());
  const fsw::Vector3 vector = turn.angle() * turn.axis();
  PoseFigures figures;
  for (std::size_t k = 0; k < 3; ++k) {
    figures.rotation_rad[k] = vector[static_cast<Eigen::Index>(k)];
    figures.translation_m[k] = pose.translation()[static_cast<Eigen::Index>(k)];
  }
  return figures;
}

fsw::Vector2 LensCalibration::project(const fsw::Vector3& point_C) const {
  return project_point<double>({fx_px, fy_px, cx_px, cy_px}, distortion.data(), point_C);
}

Calibration calibration_as_designed(const TestbedDesign& bench) {
  Calibration calibration;
  calibration.validity.bench = bench.name;
  calibration.camera_arm = arm_as_designed(bench.camera_robot, bench.camera.T_flange_camera());
  calibration.target_arm = arm_as_designed(bench.target_robot, bench.target.T_flange_target(bench.scale));
  const AxisLimits& axis = bench.track.axis;
  TrackGrid& grid = calibration.track.grid;
  grid.step_m = kTrackStep_m;
  grid.first_m = axis.lower - kTrackStep_m;
  grid.middle_m = bench.track.home_m;
  grid.plate_m = bench.camera_robot.base.position_m.z();
  const double cells = std::max(1.0, std::ceil((axis.upper - axis.lower) / kTrackStep_m - 1e-9));
  calibration.track.knots.resize(static_cast<std::size_t>(cells) + 3);
  calibration.vicon.rotation = bench.vicon.rotation;
  return calibration;
}

Eigen::Isometry3d T_L_C_of_arm(const Calibration& calibration, const Posture& posture) {
  const TrackCalibration& track = calibration.track;
  return T_L_carriage<double>(track.grid, posture.carriage_m, track.knots.front().data(),
                              static_cast<int>(track.knots.size()), track.scale) *
         T_base_flange_of(calibration.camera_arm, posture.camera_rad);
}

Eigen::Isometry3d T_L_T_of_arm(const Calibration& calibration, const Posture& posture) {
  return T_base_flange_of(calibration.target_arm, posture.target_rad);
}

Eigen::Isometry3d T_C_T_of_arms(const Calibration& calibration, const Posture& posture) {
  return T_L_C_of_arm(calibration, posture).inverse() * T_L_T_of_arm(calibration, posture);
}

Eigen::Isometry3d T_C_T_of_vicon(const Calibration& calibration, const Eigen::Isometry3d& T_V_camera,
                                 const Eigen::Isometry3d& T_V_target) {
  return calibration.vicon.T_C_object.isometry() * T_V_camera.inverse() * T_V_target *
         calibration.vicon.T_object_T.isometry();
}

Matrix6 covariance_at(const Matrix6& covariance_camera, const Eigen::Isometry3d& T_C_T) {
  Matrix6 to_target = Matrix6::Zero();
  to_target.topLeftCorner<3, 3>() = T_C_T.linear().transpose();
  to_target.bottomRightCorner<3, 3>() = T_C_T.translation().norm() * T_C_T.linear().transpose();
  return to_target * covariance_camera * to_target.transpose();
}

}  // namespace vbar::tron
