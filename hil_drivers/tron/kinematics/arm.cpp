#include "hil_drivers/tron/kinematics/arm.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vbar::tron {
namespace {

using fsw::Matrix3;
using fsw::Vector3;

constexpr double kPi = std::numbers::pi;

Matrix3 about(double angle, const Vector3& axis) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

/// Of the flange from the link of A6.
Matrix3 R_link_flange() {
  Matrix3 R;
  R << 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0;
  return R;
}

double wrapped(double angle) {
  const double turn = std::remainder(angle, 2.0 * kPi);
  return turn <= -kPi ? kPi : turn;
}

struct WristAngles {
  double a4 = 0.0, a5 = 0.0, a6 = 0.0;
  bool is_singular = false;
};

/// R = Rx(-A4) Ry(A5) Rx(-A6), A5 positive (`flip` 1) or negative (-1).
WristAngles wrist_angles(const Matrix3& R, double flip) {
  constexpr double kSingular = 1e-9;
  const double sine = std::hypot(R(1, 0), R(2, 0));
  WristAngles wrist;
  wrist.a5 = flip * std::atan2(sine, R(0, 0));
  if (sine < kSingular) {
    wrist.is_singular = true;
    // A5 is 0 or half a turn; A4 taken as 0.
    wrist.a6 = std::atan2(R(1, 2), R(1, 1));
    return wrist;
  }
  wrist.a4 = std::atan2(-flip * R(1, 0), -flip * R(2, 0));
  wrist.a6 = std::atan2(-flip * R(0, 1), flip * R(0, 2));
  return wrist;
}

}  // namespace

Eigen::Isometry3d T_base_flange(const ArmDesign& arm, const Joints& q) {
  const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY(), z = Vector3::UnitZ();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  const Matrix3 R1 = about(-q(0), z);
  const Matrix3 R2 = R1 * about(q(1), y);
  const Matrix3 R3 = R2 * about(q(2), y);
  const Matrix3 R6 = R3 * about(-q(3), x) * about(q(4), y) * about(-q(5), x);
  T.translation() = arm.d1_m * z + arm.a1_m * R1.col(0) + arm.a2_m * R2.col(0) + arm.a3_m * R3.col(2) +
                    arm.d4_m * R3.col(0) + arm.d6_m * R6.col(0);
  T.linear() = R6 * R_link_flange();
  return T;
}

ArmPoints arm_points(const ArmDesign& arm, const Joints& q) {
  const Vector3 y = Vector3::UnitY(), z = Vector3::UnitZ();
  const Matrix3 R1 = about(-q(0), z);
  const Matrix3 R2 = R1 * about(q(1), y);
  const Matrix3 R3 = R2 * about(q(2), y);
  ArmPoints points;
  points.shoulder = arm.d1_m * z + arm.a1_m * R1.col(0);
  points.elbow = points.shoulder + arm.a2_m * R2.col(0);
  points.forearm = points.elbow + arm.a3_m * R3.col(2);
  points.wrist = points.forearm + arm.d4_m * R3.col(0);
  points.flange = T_base_flange(arm, q).translation();
  return points;
}

std::vector<Branch> inverse(const ArmDesign& arm, const Eigen::Isometry3d& T) {
  std::vector<Branch> branches;
  if (!T.matrix().allFinite()) return branches;
  const Matrix3 R6 = T.linear() * R_link_flange().transpose();
  const Vector3 wrist = T.translation() - arm.d6_m * R6.col(0);
  const double radius = std::hypot(wrist.x(), wrist.y());
  const double forearm = std::hypot(arm.d4_m, arm.a3_m);
  const double rise = std::atan2(arm.a3_m, arm.d4_m);  // of the wrist from the elbow at zero angles
  const double height = wrist.z() - arm.d1_m;
  for (const double forward : {1.0, -1.0}) {
    const double ahead = forward * radius - arm.a1_m;
    const double a1 = radius == 0.0 ? 0.0 : std::atan2(-forward * wrist.y(), forward * wrist.x());
    double cosine =
        (ahead * ahead + height * height - arm.a2_m * arm.a2_m - forearm * forearm) / (2.0 * arm.a2_m * forearm);
    constexpr double kRounding = 1e-12;  // of a stretched arm
    if (std::abs(cosine) > 1.0 + kRounding) continue;
    cosine = std::clamp(cosine, -1.0, 1.0);
    for (const double up : {1.0, -1.0}) {
      const double bend = up * std::acos(cosine);
      const double a3 = rise - bend;
      const double a2 =
          std::atan2(forearm * std::sin(bend), arm.a2_m + forearm * std::cos(bend)) - std::atan2(height, ahead);
      const Matrix3 R3 = about(-a1, Vector3::UnitZ()) * about(a2 + a3, Vector3::UnitY());
      const Matrix3 R36 = R3.transpose() * R6;
      for (const double flip : {1.0, -1.0}) {
        const WristAngles found = wrist_angles(R36, flip);
        Branch& branch = branches.emplace_back();
        branch.joints_rad << wrapped(a1), wrapped(a2), wrapped(a3), wrapped(found.a4), wrapped(found.a5),
            wrapped(found.a6);
        branch.wrist_is_singular = found.is_singular;
      }
    }
  }
  return branches;
}

std::optional<Joints> within_limits(const ArmDesign& arm, const Joints& joints_rad, const Joints& near) {
  constexpr double kTurn = 2.0 * kPi;
  Joints found;
  for (std::size_t k = 0; k < kJoints; ++k) {
    const AxisLimits& axis = arm.axes[k];
    const auto at = static_cast<Eigen::Index>(k);
    std::optional<double> best;
    for (int turn = -2; turn <= 2; ++turn) {
      const double angle = joints_rad(at) + turn * kTurn;
      if (angle < axis.lower || angle > axis.upper) continue;
      if (!best || std::abs(angle - near(at)) < std::abs(*best - near(at))) best = angle;
    }
    if (!best) return std::nullopt;
    found(at) = *best;
  }
  return found;
}

double wrist_radius(const ArmDesign& arm, const Joints& joints_rad) {
  const Vector3 wrist = arm_points(arm, joints_rad).wrist;
  return std::hypot(wrist.x(), wrist.y());
}

}  // namespace vbar::tron
