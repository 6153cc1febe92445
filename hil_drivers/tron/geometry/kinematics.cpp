#include "hil_drivers/tron/geometry/kinematics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/LU>
#include <Eigen/SVD>

namespace vbar::tron {

namespace {

using fsw::Matrix3;
using fsw::Vector3;

constexpr double kPi = std::numbers::pi;
constexpr double kTurn = 2.0 * kPi;
/// Below these a closed form leaves an angle open to rounding.
constexpr double kSingularLength_m = 1e-9;
constexpr double kSingularSine = 1e-9;
/// Excess of the cosine of the elbow over 1: a wrist at full reach, rounded.
constexpr double kReachRounding = 1e-12;

Matrix3 about_x(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Matrix3 R;
  R << 1, 0, 0, 0, c, -s, 0, s, c;
  return R;
}

Matrix3 about_y(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Matrix3 R;
  R << c, 0, s, 0, 1, 0, -s, 0, c;
  return R;
}

Matrix3 about_z(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Matrix3 R;
  R << c, -s, 0, s, c, 0, 0, 0, 1;
  return R;
}

/// Rotation of 90 deg about y.
Matrix3 flange_rotation() {
  Matrix3 R;
  R << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  return R;
}

/// The value of an angle within its limits that has the smallest magnitude; between -pi and pi if none is.
double within(double angle, const AxisLimits& axis) {
  const double principal = std::remainder(angle, kTurn);
  for (const double candidate : {principal, principal - std::copysign(kTurn, principal)})
    if (candidate >= axis.lower && candidate <= axis.upper) return candidate;
  return principal;
}

bool is_inside(double angle, const AxisLimits& axis) {
  return angle >= axis.lower && angle <= axis.upper;
}

}  // namespace

Arm::Arm(const ArmDesign& design)
    : design_(design),
      forearm_m_(std::hypot(design.d4_m, design.a3_m)),
      forearm_angle_rad_(std::atan2(design.a3_m, design.d4_m)) {}

Eigen::Isometry3d Arm::forward(const Joints& q) const {
  const Matrix3 R1 = about_z(-q[0]);
  const Matrix3 R2 = R1 * about_y(q[1]);
  const Matrix3 R3 = R1 * about_y(q[1] + q[2]);
  Eigen::Isometry3d T;
  T.linear() = R3 * about_x(-q[3]) * about_y(q[4]) * about_x(-q[5]) * flange_rotation();
  T.translation() = design_.d1_m * Vector3::UnitZ() + design_.a1_m * R1.col(0) + design_.a2_m * R2.col(0) +
                    design_.d4_m * R3.col(0) + design_.a3_m * R3.col(2) + design_.d6_m * T.linear().col(2);
  T.makeAffine();
  return T;
}

ArmPoints Arm::points(const Joints& q) const {
  const Matrix3 R1 = about_z(-q[0]);
  const Matrix3 R3 = R1 * about_y(q[1] + q[2]);
  ArmPoints points;
  points.shoulder = design_.d1_m * Vector3::UnitZ() + design_.a1_m * R1.col(0);
  points.elbow = points.shoulder + design_.a2_m * (R1 * about_y(q[1])).col(0);
  points.wrist = points.elbow + design_.d4_m * R3.col(0) + design_.a3_m * R3.col(2);
  // The flange's z is the x of the last link, which A6 leaves as it is.
  points.flange = points.wrist + design_.d6_m * (R3 * (about_x(-q[3]) * about_y(q[4]).col(0)));
  return points;
}

Eigen::Matrix<double, 6, 6> Arm::jacobian(const Joints& q) const {
  const ArmPoints at = points(q);
  const Matrix3 R1 = about_z(-q[0]);
  const Matrix3 R3 = R1 * about_y(q[1] + q[2]);
  const Matrix3 R4 = R3 * about_x(-q[3]);
  const Matrix3 R5 = R4 * about_y(q[4]);
  const std::array<Vector3, kJoints> axes{-Vector3::UnitZ(), R1.col(1), R1.col(1), -R3.col(0), R4.col(1), -R5.col(0)};
  const std::array<Vector3, kJoints> through{at.base, at.shoulder, at.elbow, at.wrist, at.wrist, at.wrist};
  Eigen::Matrix<double, 6, 6> J;
  for (std::size_t k = 0; k < kJoints; ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    J.block<3, 1>(0, column) = axes[k].cross(at.flange - through[k]);
    J.block<3, 1>(3, column) = axes[k];
  }
  return J;
}

void Arm::add_wrist(const Eigen::Isometry3d& T, const Vector3& arm_angles, const Joints& near, Branches& found) const {
  const Matrix3 R3 = about_z(-arm_angles[0]) * about_y(arm_angles[1] + arm_angles[2]);
  // Rx(-A4) Ry(A5) Rx(-A6).
  const Matrix3 M = R3.transpose() * T.linear() * flange_rotation().transpose();
  const double sine = std::hypot(M(1, 0), M(2, 0));
  for (const double sign : {1.0, -1.0}) {
    Joints q;
    q.head<3>() = arm_angles;
    q[4] = std::atan2(sign * sine, M(0, 0));
    if (sine > kSingularSine) {
      q[3] = std::atan2(-sign * M(1, 0), -sign * M(2, 0));
      q[5] = std::atan2(-sign * M(0, 1), sign * M(0, 2));
    } else {
      // A4 and A6 turn about one line: only their sum (A5 = 0) or difference (180 deg) follows.
      found.is_wrist_singular = true;
      const double along = std::copysign(1.0, M(0, 0));
      q[3] = near[3];
      q[5] = along * (-std::atan2(M(2, 1), M(1, 1)) - near[3]);
    }
    bool is_within = true;
    for (std::size_t k = 0; k < kJoints; ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      q[at] = within(q[at], design_.axes[k]);
      is_within = is_within && is_inside(q[at], design_.axes[k]);
    }
    found.joints[found.count] = q;
    found.is_within_limits[found.count] = is_within;
    ++found.count;
  }
}

Branches Arm::inverse(const Eigen::Isometry3d& T, const Joints& near) const {
  Branches found;
  if (!T.matrix().allFinite() || !near.allFinite()) return found;
  const Vector3 wrist = T.translation() - design_.d6_m * T.linear().col(2);
  const double radius = std::hypot(wrist.x(), wrist.y());
  const double height = wrist.z() - design_.d1_m;
  found.is_shoulder_singular = radius < kSingularLength_m;
  const double ahead = found.is_shoulder_singular ? near[0] : -std::atan2(wrist.y(), wrist.x());
  for (const double side : {1.0, -1.0}) {
    const double a1 = side > 0.0 ? ahead : ahead + kPi;
    const double rho = side * radius - design_.a1_m;
    // Two links in the vertical plane: upper arm and the line from elbow to wrist.
    const double cosine = (rho * rho + height * height - design_.a2_m * design_.a2_m - forearm_m_ * forearm_m_) /
                          (2.0 * design_.a2_m * forearm_m_);
    if (!(std::abs(cosine) <= 1.0 + kReachRounding)) continue;
    const double bend = std::acos(std::clamp(cosine, -1.0, 1.0));
    found.is_elbow_singular = found.is_elbow_singular || bend < kSingularSine || bend > kPi - kSingularSine;
    for (const double sign : {1.0, -1.0}) {
      const double upper = std::atan2(height, rho) -
                           std::atan2(forearm_m_ * std::sin(sign * bend), design_.a2_m + forearm_m_ * std::cos(bend));
      const double a3 = forearm_angle_rad_ - sign * bend;
      add_wrist(T, Vector3(a1, -upper, a3), near, found);
    }
  }
  return found;
}

std::vector<Joints> Arm::turns(const Joints& joints) const {
  std::vector<Joints> all;
  if (!joints.allFinite()) return all;
  all.push_back(joints);
  for (std::size_t k = 0; k < kJoints; ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    const AxisLimits& axis = design_.axes[k];
    std::vector<Joints> next;
    const double first = joints[at] + kTurn * std::ceil((axis.lower - joints[at]) / kTurn);
    for (const Joints& one : all) {
      for (int turn = 0; first + turn * kTurn <= axis.upper; ++turn) {
        next.push_back(one);
        // The angle as given if it is within limits, without rounding.
        const double angle = first + turn * kTurn;
        next.back()[at] = std::abs(angle - joints[at]) < 1.0 ? joints[at] : angle;
      }
    }
    all = std::move(next);
  }
  return all;
}

Joints Arm::nearest_turn(const Joints& joints, const Joints& near) const {
  Joints result = joints;
  for (std::size_t k = 0; k < kJoints; ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    const AxisLimits& axis = design_.axes[k];
    double best = joints[at];
    for (const double turn : {-kTurn, kTurn}) {
      const double candidate = joints[at] + turn;
      if (is_inside(candidate, axis) && std::abs(candidate - near[at]) < std::abs(best - near[at])) best = candidate;
    }
    result[at] = best;
  }
  return result;
}

bool Arm::is_within_limits(const Joints& joints) const {
  for (std::size_t k = 0; k < kJoints; ++k)
    if (!is_inside(joints[static_cast<Eigen::Index>(k)], design_.axes[k])) return false;
  return true;
}

double Arm::wrist_from_a1_m(const Joints& joints) const {
  return points(joints).wrist.head<2>().norm();
}

namespace {

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

ArmPair::ArmPair(const TestbedDesign& bench)
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
