#include "hil_drivers/tron/collision/bench_bodies.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "fsw/network/sizes.h"
#include "host_sim/mission/body_file.h"

namespace vbar::tron {
namespace {

using fsw::Vector3;

constexpr std::array<const char*, kArmBodies> kCameraNames{"the carriage",
                                                           "the column of the camera's arm",
                                                           "the upper arm of the camera's arm",
                                                           "the forearm of the camera's arm",
                                                           "the wrist of the camera's arm",
                                                           "the camera"};
constexpr std::array<const char*, kArmBodies> kTargetNames{"the pedestal",
                                                           "the column of the target's arm",
                                                           "the upper arm of the target's arm",
                                                           "the forearm of the target's arm",
                                                           "the wrist of the target's arm",
                                                           "the rod of the target"};
constexpr const char* kTarget = "the target";
constexpr const char* kRoom = "the room";
constexpr const char* kNowhere = "a posture that is not finite";

std::array<Capsule, kArmBodies> arm_bodies(const Arm& arm, const Eigen::Isometry3d& T_L_base, const Joints& joints,
                                           double tool_m, double tool_radius_m, const BenchFile& bench) {
  const ArmPoints at = arm.points(joints);
  const auto& radius_m = arm.design().body_radius_m;
  const Vector3 base = T_L_base.translation(), shoulder = T_L_base * at.shoulder, elbow = T_L_base * at.elbow;
  const Vector3 wrist = T_L_base * at.wrist, flange = T_L_base * at.flange;
  const bool stands = T_L_base.linear()(2, 2) > 0.0;
  const Vector3 foot(base.x(), base.y(), stands ? bench.room_low_m.z() : bench.room_high_m.z());
  const Vector3 ahead = (flange - wrist).normalized();
  return {{{foot, base, radius_m[0]},
           {base, shoulder, radius_m[0]},
           {shoulder, elbow, radius_m[1]},
           {elbow, wrist, radius_m[2]},
           {wrist, flange, radius_m[3]},
           {flange, flange + tool_m * ahead, tool_radius_m}}};
}

bool are_near(const Capsule& one, const Capsule& other, double clearance_m) {
  // Written so that a NaN is near.
  return !(segment_distance(one.from, one.to, other.from, other.to) >= one.radius_m + other.radius_m + clearance_m);
}

bool are_near(const Capsule& capsule, const OrientedBox& box, double clearance_m) {
  const double apart = capsule.radius_m + clearance_m;
  const Vector3 middle = box.T_L_box.translation();
  if (segment_distance(capsule.from, capsule.to, middle, middle) >= apart + box.half_m.norm()) return false;
  return !(box_distance(capsule.from, capsule.to, box) >= apart);
}

/// Bodies of one arm that are not neighbours and can meet.
constexpr std::array<std::pair<ArmBody, ArmBody>, 8> kOwnPairs{{{kColumn, kForearm},
                                                                {kColumn, kWrist},
                                                                {kColumn, kTool},
                                                                {kStand, kForearm},
                                                                {kStand, kWrist},
                                                                {kStand, kTool},
                                                                {kUpperArm, kWrist},
                                                                {kUpperArm, kTool}}};
constexpr ArmBody kFirstMoving = kUpperArm;

/// Distance from each axis to the farthest point that it turns, at most.
std::array<double, kJoints> reach_of(const ArmDesign& arm, double tool_m) {
  const double hand = arm.d6_m + tool_m, fore = std::hypot(arm.d4_m, arm.a3_m) + hand, all = arm.a2_m + fore;
  return {arm.a1_m + all, all, fore, hand, hand, hand};
}

double travel_of(const Joints& from, const Joints& to, const std::array<double, kJoints>& reach_m) {
  double travel = 0.0;
  for (std::size_t k = 0; k < kJoints; ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    travel += std::abs(to[at] - from[at]) * reach_m[k];
  }
  return travel;
}

}  // namespace

BenchBodies::BenchBodies(const BenchFile& bench) : bench_(bench), arms_(bench) {
  camera_reach_m_ = reach_of(bench.camera_robot.design, bench.camera.ahead_m + bench.camera.body_radius_m);
  const double hull_m = (bench.target.body_high_m - bench.target.body_low_m).norm() * bench.scale;
  target_reach_m_ = reach_of(bench.target_robot.design, bench.target.stand_off_m + hull_m);
}

Bodies BenchBodies::at(const Posture& posture) const {
  Bodies bodies;
  bodies.camera_arm = arm_bodies(arms_.camera_arm(), arms_.T_L_camera_base(posture.carriage_m), posture.camera_rad,
                                 bench_.camera.ahead_m, bench_.camera.body_radius_m, bench_);
  bodies.target_arm = arm_bodies(arms_.target_arm(), arms_.T_L_target_base(), posture.target_rad,
                                 bench_.target.stand_off_m, bench_.target.rod_radius_m, bench_);
  bodies.T_L_C = arms_.camera_pose(posture);
  bodies.T_L_T = arms_.target_pose(posture);
  bodies.target.T_L_box = bodies.T_L_T;
  bodies.target.T_L_box.translation() =
      bodies.T_L_T * Vector3(0.5 * bench_.scale * (bench_.target.body_low_m + bench_.target.body_high_m));
  bodies.target.half_m = 0.5 * bench_.scale * (bench_.target.body_high_m - bench_.target.body_low_m);
  return bodies;
}

const char* BenchBodies::outside_room(const Bodies& bodies) const {
  const auto is_inside = [&](const Vector3& point, double radius_m) {
    const double margin = radius_m + bench_.motion.clearance_m;
    return ((point - bench_.room_low_m).array() >= margin).all() &&
           ((bench_.room_high_m - point).array() >= margin).all();
  };
  for (std::size_t k = kFirstMoving; k < kArmBodies; ++k) {
    // The end of each; its beginning is the end of the one before.
    if (!is_inside(bodies.camera_arm[k].to, bodies.camera_arm[k].radius_m)) return kCameraNames[k];
    if (!is_inside(bodies.target_arm[k].to, bodies.target_arm[k].radius_m)) return kTargetNames[k];
  }
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 signs(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
    if (!is_inside(bodies.target.T_L_box * Vector3(signs.cwiseProduct(bodies.target.half_m)), 0.0)) return kTarget;
  }
  return nullptr;
}

BenchBodies::Pair BenchBodies::touching(const Bodies& bodies) const {
  const double clearance_m = bench_.motion.clearance_m;
  if (!bodies.T_L_C.matrix().allFinite() || !bodies.T_L_T.matrix().allFinite()) return {kNowhere, kRoom};
  if (const char* outside = outside_room(bodies)) return {outside, kRoom};
  for (const auto& [one, other] : kOwnPairs) {
    if (are_near(bodies.camera_arm[one], bodies.camera_arm[other], clearance_m))
      return {kCameraNames[one], kCameraNames[other]};
    if (are_near(bodies.target_arm[one], bodies.target_arm[other], clearance_m))
      return {kTargetNames[one], kTargetNames[other]};
  }
  // The rod ends at the target, and the wrist before it points there.
  for (std::size_t k = kStand; k <= kForearm; ++k)
    if (are_near(bodies.target_arm[k], bodies.target, clearance_m)) return {kTargetNames[k], kTarget};
  for (std::size_t k = 0; k < kArmBodies; ++k) {
    if (are_near(bodies.camera_arm[k], bodies.target, clearance_m)) return {kCameraNames[k], kTarget};
    for (std::size_t n = 0; n < kArmBodies; ++n)
      if ((k >= kFirstMoving || n >= kFirstMoving) && are_near(bodies.camera_arm[k], bodies.target_arm[n], clearance_m))
        return {kCameraNames[k], kTargetNames[n]};
  }
  return {};
}

std::string BenchBodies::collision(const Bodies& bodies) const {
  const Pair found = touching(bodies);
  return found.one == nullptr ? std::string() : fmt::format("{} and {}", found.one, found.other);
}

bool BenchBodies::is_free(const Bodies& bodies) const {
  return touching(bodies).one == nullptr;
}

std::string BenchBodies::collision_between(const Posture& from, const Posture& to, double step_m) const {
  const double travel_m =
      std::max(travel_of(from.camera_rad, to.camera_rad, camera_reach_m_) + std::abs(to.carriage_m - from.carriage_m),
               travel_of(from.target_rad, to.target_rad, target_reach_m_));
  if (!std::isfinite(travel_m)) return fmt::format("{} and {}", kNowhere, kRoom);
  const int samples = std::max(1, static_cast<int>(std::ceil(travel_m / step_m)));
  for (int k = samples; k >= 0; --k) {
    const double share = static_cast<double>(k) / samples;
    const Posture posture{from.camera_rad + share * (to.camera_rad - from.camera_rad),
                          from.target_rad + share * (to.target_rad - from.target_rad),
                          from.carriage_m + share * (to.carriage_m - from.carriage_m)};
    if (const std::string found = collision(at(posture)); !found.empty()) return found;
  }
  return {};
}

int BenchBodies::hidden(const Bodies& bodies, std::span<const Vector3> points_body) const {
  const Vector3 eye = bodies.T_L_C.translation();
  int count = 0;
  for (const Vector3& point : points_body) {
    const Vector3 seen = bodies.T_L_T * Vector3(bench_.scale * point);
    const auto hides = [&](const Capsule& body) {
      return segment_distance(eye, seen, body.from, body.to) < body.radius_m;
    };
    // The camera looks ahead of its own wrist and body.
    const bool is_hidden = std::ranges::any_of(bodies.target_arm, hides) ||
                           std::any_of(bodies.camera_arm.begin(), bodies.camera_arm.begin() + kWrist, hides);
    count += is_hidden ? 1 : 0;
  }
  return count;
}

std::vector<Vector3> BenchBodies::points_to_see(const std::filesystem::path& data_directory) const {
  std::vector<Vector3> points = mission::load_keypoints(
      data_directory / "models" / (bench_.target.model + "_keypoints.toml"), fsw::network::kKeypoints);
  points.emplace_back(0.5 * (bench_.target.body_low_m + bench_.target.body_high_m));
  return points;
}

}  // namespace vbar::tron
