#pragma once
// Kinematics of an arm of six axes with a spherical wrist, as designed (ArmDesign, bench_file.h).

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/kinematics/posture.h"

namespace vbar::tron {

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

}  // namespace vbar::tron
