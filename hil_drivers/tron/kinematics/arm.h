#pragma once
// Forward and inverse kinematics of an arm of six axes with a spherical wrist, as designed (ArmDesign, bench_file.h).
//
// The axes of A4, A5 and A6 meet in a point, so position and orientation separate (Pieper 1968): two solutions of the
// shoulder, two of the elbow, two of the wrist.

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/kinematics/posture.h"

namespace vbar::tron {

/// Points of an arm in its base frame.
struct ArmPoints {
  fsw::Vector3 shoulder, elbow, wrist, flange;  ///< on the axes of A2 and A3; where those of A4 to A6 meet; flange
  fsw::Vector3 forearm;                         ///< beside the elbow, where the forearm begins
};

[[nodiscard]] Eigen::Isometry3d T_base_flange(const ArmDesign& arm, const Joints& joints_rad);
[[nodiscard]] ArmPoints arm_points(const ArmDesign& arm, const Joints& joints_rad);

/// A branch of the inverse, each angle in (-pi, pi], whatever the limits.
struct Branch {
  Joints joints_rad;
  bool wrist_is_singular = false;  ///< A4 and A6 turn about one axis: A4 is then 0
};

/// Up to eight; none where the wrist is out of reach, the shoulder's two are one where it is on the axis of A1.
[[nodiscard]] std::vector<Branch> inverse(const ArmDesign& arm, const Eigen::Isometry3d& T_base_flange);

/// The angles with whole turns added so that all are within their limits and each as near to `near` as possible;
/// nothing if an axis cannot.
[[nodiscard]] std::optional<Joints> within_limits(const ArmDesign& arm, const Joints& joints_rad, const Joints& near);

/// Horizontal distance of the wrist from the axis of A1, m: the shoulder is singular at 0.
[[nodiscard]] double wrist_radius(const ArmDesign& arm, const Joints& joints_rad);

}  // namespace vbar::tron
