#include "hil_drivers/tron/kinematics/arm.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

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

}  // namespace vbar::tron
