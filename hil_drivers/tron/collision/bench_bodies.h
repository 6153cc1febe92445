#pragma once
// Bodies of a bench at a posture: whether they are apart, and what they hide from the camera.

#include <array>
#include <span>
#include <string>
#include <vector>

#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/collision/distance.h"
#include "hil_drivers/tron/kinematics/arm_pair.h"

namespace vbar::tron {

/// Of an arm, from its base to what it holds.
enum ArmBody : std::size_t {
  kStand,   ///< carriage under the ceiling, or pedestal on the floor
  kColumn,  ///< base to A2
  kUpperArm,
  kForearm,
  kWrist,  ///< to the flange
  kTool,   ///< camera, or the rod that holds the target
  kArmBodies
};

struct Bodies {
  std::array<Capsule, kArmBodies> camera_arm{}, target_arm{};  ///< L
  OrientedBox target;                                          ///< hull
  Eigen::Isometry3d T_L_C, T_L_T;
};

class BenchBodies {
 public:
  explicit BenchBodies(const BenchFile& bench);

  [[nodiscard]] const ArmPair& arms() const { return arms_; }

  [[nodiscard]] Bodies at(const Posture& posture) const;

  /// Which two are closer than the clearance, "target and forearm of the target's arm"; empty: none. The room counts,
  /// and so do bodies of one arm that are not neighbours. A posture that is not finite is a collision.
  [[nodiscard]] std::string collision(const Bodies& bodies) const;
  [[nodiscard]] bool is_free(const Bodies& bodies) const;

  /// Which two are closer than the clearance anywhere on the straight path in joint space, sampled so that no body
  /// moves by more than `step_m` between two samples; empty: none.
  [[nodiscard]] std::string collision_between(const Posture& from, const Posture& to, double step_m = 0.01) const;

  /// How many of the points, full-scale body frame, an arm or the rod hides from the camera.
  [[nodiscard]] int hidden(const Bodies& bodies, std::span<const fsw::Vector3> points_body) const;

  /// Keypoints of the target's model and the middle of its hull, full-scale body frame.
  [[nodiscard]] std::vector<fsw::Vector3> points_to_see(const std::filesystem::path& data_directory) const;

 private:
  struct Pair {
    const char *one = nullptr, *other = nullptr;
  };
  [[nodiscard]] Pair touching(const Bodies& bodies) const;
  [[nodiscard]] const char* outside_room(const Bodies& bodies) const;

  BenchFile bench_;
  ArmPair arms_;
  std::array<double, kJoints> camera_reach_m_{}, target_reach_m_{};  ///< of each axis: farthest point that it turns
};

}  // namespace vbar::tron
