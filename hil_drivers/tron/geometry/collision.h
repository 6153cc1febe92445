#pragma once
// Bodies of a testbed at a posture: their clearance, and what they hide from the camera.

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "hil_drivers/tron/geometry/kinematics.h"
#include "hil_drivers/tron/geometry/testbed_design.h"

namespace vbar::tron {

// Distances of segments from segments and boxes. They are written out, in 55 lines, of which the Flexible Collision
// Library (FCL 0.7) would leave 25, because it is slower: on one computer 0.14 against 0.06 us for two capsules and 1.7
// against 0.4 us for capsule and box, without the making of its shapes. Over 1e5 random pairs the distances of capsules
// are equal within 2e-12 m; from boxes they differ by at most 0.4 mm with FCL's tolerance at 1e-9, and by 0.2 m in the
// worst pair at its default of 1e-6, where its iteration ends too early.

/// Holds all points within `radius_m` of a segment.
struct Capsule {
  fsw::Vector3 from = fsw::Vector3::Zero(), to = fsw::Vector3::Zero();
  double radius_m = 0.0;
};

struct OrientedBox {
  Eigen::Isometry3d T_L_box = Eigen::Isometry3d::Identity();  ///< origin in its middle, axes along its edges
  fsw::Vector3 half_m = fsw::Vector3::Zero();
};

/// Returns the distance between two segments (Ericson 2004, section 5.1.9).
[[nodiscard]] double segment_distance(const fsw::Vector3& a_from, const fsw::Vector3& a_to, const fsw::Vector3& b_from,
                                      const fsw::Vector3& b_to);
/// Returns the distance of a segment from a box; 0 if it enters the box. The error is 1e-6 of the segment's length.
[[nodiscard]] double box_distance(const fsw::Vector3& from, const fsw::Vector3& to, const OrientedBox& box);

/// Numbers the bodies of an arm, from its base to what it holds.
enum ArmBody : std::size_t {
  kStand,   ///< carriage under the ceiling, or pedestal on the floor
  kColumn,  ///< base to A2
  kUpperArm,
  kForearm,
  kWrist,  ///< to the flange
  kTool,   ///< camera, or the rod that holds the target
  kArmBodies
};

using ArmCapsules = std::array<Capsule, kArmBodies>;  ///< L

struct Bodies {
  ArmCapsules camera_arm{}, target_arm{};
  OrientedBox target;  ///< hull
  Eigen::Isometry3d T_L_C, T_L_T;
};

class TestbedBodies {
 public:
  explicit TestbedBodies(const TestbedDesign& bench);

  [[nodiscard]] const ArmPair& arms() const { return arms_; }

  [[nodiscard]] Bodies at(const Posture& posture) const;

  /// Names the two bodies that are closer than the clearance, "target and forearm of the target's arm"; empty: none.
  /// The room counts, and so do bodies of one arm that are not neighbours. A posture that is not finite is a collision.
  [[nodiscard]] std::string collision(const Bodies& bodies) const { return collision(bodies, clearance_m()); }
  [[nodiscard]] std::string collision(const Bodies& bodies, double clearance_m) const;
  [[nodiscard]] double clearance_m() const { return bench_.motion.clearance_m; }

  [[nodiscard]] bool is_free(const Bodies& bodies) const { return collision(bodies).empty(); }
  // Returns the bodies in parts, for a search: each arm by itself, the target as held, and both together.
  [[nodiscard]] ArmCapsules camera_arm_at(const Joints& joints_rad, double carriage_m) const;
  [[nodiscard]] ArmCapsules target_arm_at(const Joints& joints_rad) const;
  [[nodiscard]] OrientedBox hull_at(const Eigen::Isometry3d& T_L_T) const;
  [[nodiscard]] bool is_camera_arm_free(const ArmCapsules& arm) const;
  [[nodiscard]] bool is_target_arm_free(const ArmCapsules& arm, const OrientedBox& hull) const;
  [[nodiscard]] bool are_apart(const ArmCapsules& camera_arm, const ArmCapsules& target_arm,
                               const OrientedBox& hull) const;

  /// Names the two bodies that are closer than the clearance anywhere on the straight path in joint space, sampled so
  /// that no body moves by more than `step_m` between two samples; empty: none.
  [[nodiscard]] std::string collision_between(const Posture& from, const Posture& to, double clearance_m,
                                              double step_m = 0.01) const;

  /// Returns the number of points, full-scale body frame, that an arm or the rod hides from the camera.
  [[nodiscard]] int hidden(const Bodies& bodies, std::span<const fsw::Vector3> points_body) const;

  /// Returns one bit a point, L: hidden by the camera's arm (which looks ahead of its own wrist), by the target's arm.
  [[nodiscard]] static std::uint32_t hidden_by_camera_arm(const ArmCapsules& arm, const fsw::Vector3& eye,
                                                          std::span<const fsw::Vector3> points_L);
  [[nodiscard]] static std::uint32_t hidden_by_target_arm(const ArmCapsules& arm, const fsw::Vector3& eye,
                                                          std::span<const fsw::Vector3> points_L);
  /// Returns one bit a point, L: set if an arm's shadow falls on the point. Its light comes from the lamp in direction
  /// `towards_lamp`.
  [[nodiscard]] std::uint32_t shaded_by(const ArmCapsules& arm, const fsw::Vector3& towards_lamp,
                                        std::span<const fsw::Vector3> points_L) const;
  /// Returns four points of each face of the hull that the lamp lights, L.
  [[nodiscard]] static std::vector<fsw::Vector3> lit_points(const OrientedBox& hull, const fsw::Vector3& towards_lamp);
  /// Converts points from the full-scale body frame; at most 32.
  [[nodiscard]] std::vector<fsw::Vector3> points_at(const Eigen::Isometry3d& T_L_T,
                                                    std::span<const fsw::Vector3> points_body) const;

  /// Returns the number of lit points of the hull that are in the shadow of an arm.
  [[nodiscard]] int shaded(const Bodies& bodies, const fsw::Vector3& towards_lamp) const;

  /// Returns keypoints of the target's model and the middle of its hull, full-scale body frame.
  [[nodiscard]] std::vector<fsw::Vector3> points_to_see(const std::filesystem::path& data_directory) const;

 private:
  struct Pair {
    const char *one = nullptr, *other = nullptr;
  };
  [[nodiscard]] bool is_in_room(const fsw::Vector3& point, double margin_m) const;
  [[nodiscard]] Pair touching_of_arm(const ArmCapsules& arm, const std::array<const char*, kArmBodies>& names,
                                     double clearance_m) const;
  [[nodiscard]] Pair touching_of_target(const ArmCapsules& arm, const OrientedBox& hull, double clearance_m) const;
  [[nodiscard]] Pair touching_across(const ArmCapsules& camera_arm, const ArmCapsules& target_arm,
                                     const OrientedBox& hull, double clearance_m) const;

  TestbedDesign bench_;
  ArmPair arms_;
  std::array<double, kJoints> camera_reach_m_{}, target_reach_m_{};  ///< farthest point that each axis turns
};

}  // namespace vbar::tron
