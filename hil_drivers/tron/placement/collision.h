#pragma once
// Clearance of both arms from each other, from themselves, room, camera and target; what of the target the arm hides.
// Links are capsules, the target is the box of its hull, the room a box.

#include <string>
#include <vector>

#include "hil_drivers/tron/kinematics/geometry.h"

namespace vbar::tron {

struct Capsule {
  fsw::Vector3 from, to;  ///< L
  double radius_m = 0.0;
};

/// Radii that enclose the links of an arm of this size. They are measured off drawings, not from a data sheet.
inline constexpr double kColumnRadius_m = 0.13, kUpperArmRadius_m = 0.08, kForearmRadius_m = 0.065,
                        kWristRadius_m = 0.045;

/// An arm as it stands: column, upper arm, forearm, wrist, tool.
enum ArmLink { kColumn, kUpperArm, kForearm, kWrist, kTool, kArmLinks };
using ArmCapsules = std::array<Capsule, kArmLinks>;

/// The tool of the camera's arm is the camera, that of the target's the rod.
[[nodiscard]] ArmCapsules camera_arm_capsules(const Geometry& geometry, const Posture& posture);
[[nodiscard]] ArmCapsules target_arm_capsules(const Geometry& geometry, const Posture& posture);

[[nodiscard]] double distance(const Capsule& a, const Capsule& b);  ///< of the surfaces; negative if they overlap
/// Of a capsule from a box in the frame T, m; 0 inside.
[[nodiscard]] double distance(const Capsule& a, const Eigen::Isometry3d& T_L_T, const fsw::Vector3& low_T,
                              const fsw::Vector3& high_T);

class CollisionCheck {
 public:
  explicit CollisionCheck(const Geometry& geometry) : geometry_(geometry) {}

  /// Empty if everything keeps the clearance; otherwise which two things do not.
  [[nodiscard]] std::string conflict(const Posture& posture) const;
  /// The same of all postures of straight lines in joint space, no point moving more than `step_m` between two.
  [[nodiscard]] std::string conflict_on_way(const Posture& from, const Posture& to, double step_m = 0.01) const;

  /// Corners of a way that is free, `from` and `to` included: straight, or over a posture in which one arm or both are
  /// retracted. Empty: there is none.
  [[nodiscard]] std::vector<Posture> free_way(const Posture& from, const Posture& to) const;

 private:
  const Geometry& geometry_;
};

/// Points, in T, that arm or rod of the target hide from the camera.
[[nodiscard]] int hidden_points(const Geometry& geometry, const Posture& posture,
                                const std::vector<fsw::Vector3>& points_T);

}  // namespace vbar::tron
