#pragma once
// Both arms, the track and the mounts of a testbed, as designed.

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "hil_drivers/tron/geometry/testbed_design.h"

namespace vbar::tron {

// Places of both arms and the carriage, and their motions.

using Joints = Eigen::Matrix<double, 6, 1>;  ///< A1..A6, rad

struct Posture {
  Joints camera_rad = Joints::Zero(), target_rad = Joints::Zero();
  double carriage_m = 0.0;  ///< along L x
};

[[nodiscard]] inline bool is_finite(const Posture& posture) {
  return posture.camera_rad.allFinite() && posture.target_rad.allFinite() && std::isfinite(posture.carriage_m);
}

/// Gives a posture of both arms and the carriage for every robot cycle.
struct Motion {
  int cycles = 0;                               ///< number of cycles; the last is at rest
  std::function<Posture(int cycle)> at;         ///< from 1
  std::function<Motion(int cycle)> stop_after;  ///< slows down along the same path, after that cycle
};

enum class MotionEnd {
  kArrived,
  kInterrupted,  ///< both arms are at rest, or stopped by their controllers: recover()
};

// Kinematics of an arm of six axes with a spherical wrist, as designed (ArmDesign, testbed_design.h).

inline constexpr std::size_t kBranches = 8;

/// Holds points of an arm in its base frame, m.
struct ArmPoints {
  fsw::Vector3 base = fsw::Vector3::Zero(), shoulder, elbow, wrist, flange;
};

/// Holds all postures of an arm for one pose of its flange: two each of shoulder, elbow and wrist.
struct Branches {
  std::array<Joints, kBranches> joints;  ///< rad; each angle is the one within limits with the smallest magnitude, or
                                         ///< between -pi and pi if none is
  std::array<bool, kBranches> is_within_limits{};
  std::size_t count = 0;  ///< 0, 4 or 8; 0: the wrist is out of reach, or the pose is not finite
  // Flags of singularities. The joints are then one choice of infinitely many.
  bool is_shoulder_singular = false;  ///< wrist on the axis of A1: A1 is that of `near`
  bool is_elbow_singular = false;     ///< stretched or folded: both elbow branches coincide
  bool is_wrist_singular = false;     ///< A5 = 0: A4 is that of `near`
};

class Arm {
 public:
  explicit Arm(const ArmDesign& design);

  [[nodiscard]] const ArmDesign& design() const { return design_; }

  /// Returns T_base_flange.
  [[nodiscard]] Eigen::Isometry3d forward(const Joints& joints_rad) const;
  [[nodiscard]] ArmPoints points(const Joints& joints_rad) const;

  /// Returns the derivative of the flange's pose, base frame: rows 0 to 2 translation of its origin, 3 to 5 rotation.
  [[nodiscard]] Eigen::Matrix<double, 6, 6> jacobian(const Joints& joints_rad) const;

  /// Solves in closed form. `near` matters at singularities only.
  [[nodiscard]] Branches inverse(const Eigen::Isometry3d& T_base_flange, const Joints& near = Joints::Zero()) const;

  /// Returns the same posture with every combination of full turns of the axes within limits; empty if there is none.
  [[nodiscard]] std::vector<Joints> turns(const Joints& joints_rad) const;
  /// Returns the element of `turns` whose axes are nearest to `near`, each by itself. `joints_rad` must be within
  /// limits.
  [[nodiscard]] Joints nearest_turn(const Joints& joints_rad, const Joints& near) const;

  [[nodiscard]] bool is_within_limits(const Joints& joints_rad) const;

  /// Returns the distance of the wrist from the axis of A1, m.
  [[nodiscard]] double wrist_from_a1_m(const Joints& joints_rad) const;

 private:
  void add_wrist(const Eigen::Isometry3d& T, const fsw::Vector3& arm_angles, const Joints& near, Branches& found) const;

  ArmDesign design_;
  double forearm_m_;          ///< from the elbow to the wrist
  double forearm_angle_rad_;  ///< angle of that line above the forearm's x
};

class ArmPair {
 public:
  explicit ArmPair(const TestbedDesign& bench);

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
