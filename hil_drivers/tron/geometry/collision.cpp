#include "hil_drivers/tron/geometry/collision.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "fsw/vision/pose/architecture.h"
#include "host_sim/mission/body_file.h"

namespace vbar::tron {

namespace {

using fsw::Vector3;

constexpr double kPoint = 1e-24;  ///< squared length of a segment that is a point
constexpr int kSections = 30;     ///< steps of the golden ratio: 0.618^30 is 5e-7

double point_box_distance(const Vector3& point, const Vector3& half) {
  return (point.cwiseAbs() - half).cwiseMax(0.0).norm();
}

}  // namespace

double segment_distance(const Vector3& a_from, const Vector3& a_to, const Vector3& b_from, const Vector3& b_to) {
  const Vector3 a = a_to - a_from, b = b_to - b_from, r = a_from - b_from;
  const double aa = a.squaredNorm(), bb = b.squaredNorm(), br = b.dot(r);
  double s = 0.0, t = 0.0;
  if (aa <= kPoint && bb <= kPoint) return r.norm();
  if (aa <= kPoint) {
    t = std::clamp(br / bb, 0.0, 1.0);
  } else {
    const double ar = a.dot(r);
    if (bb <= kPoint) {
      s = std::clamp(-ar / aa, 0.0, 1.0);
    } else {
      const double ab = a.dot(b), determinant = aa * bb - ab * ab;
      s = determinant > 0.0 ? std::clamp((ab * br - ar * bb) / determinant, 0.0, 1.0) : 0.0;
      t = (ab * s + br) / bb;
      if (t < 0.0) {
        t = 0.0;
        s = std::clamp(-ar / aa, 0.0, 1.0);
      } else if (t > 1.0) {
        t = 1.0;
        s = std::clamp((ab - ar) / aa, 0.0, 1.0);
      }
    }
  }
  return (r + s * a - t * b).norm();
}

double box_distance(const Vector3& from, const Vector3& to, const OrientedBox& box) {
  const Eigen::Isometry3d T_box_L = box.T_L_box.inverse();
  const Vector3 start = T_box_L * from, way = T_box_L.linear() * (to - from);
  // The distance is convex along the segment: section by the golden ratio.
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
  const auto distance = [&](double t) { return point_box_distance(start + t * way, box.half_m); };
  double low = 0.0, high = 1.0, x1 = 1.0 - ratio, x2 = ratio, f1 = distance(x1), f2 = distance(x2);
  for (int k = 0; k < kSections; ++k) {
    if (f1 <= f2) {
      high = x2;
      x2 = x1;
      f2 = f1;
      x1 = high - ratio * (high - low);
      f1 = distance(x1);
    } else {
      low = x1;
      x1 = x2;
      f1 = f2;
      x2 = low + ratio * (high - low);
      f2 = distance(x2);
    }
  }
  return std::min({f1, f2, distance(0.0), distance(1.0)});
}

namespace {

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

ArmCapsules arm_bodies(const Arm& arm, const Eigen::Isometry3d& T_L_base, const Joints& joints, double tool_m,
                       double tool_radius_m, const TestbedDesign& bench) {
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

std::uint32_t hidden_by(std::span<const Capsule> bodies, const Vector3& eye, std::span<const Vector3> points) {
  std::uint32_t mask = 0;
  for (std::size_t k = 0; k < points.size() && k < 32; ++k) {
    const auto hides = [&](const Capsule& body) {
      return segment_distance(eye, points[k], body.from, body.to) < body.radius_m;
    };
    if (std::ranges::any_of(bodies, hides)) mask |= std::uint32_t{1} << k;
  }
  return mask;
}

}  // namespace

TestbedBodies::TestbedBodies(const TestbedDesign& bench) : bench_(bench), arms_(bench) {
  camera_reach_m_ = reach_of(bench.camera_robot.design, bench.camera.ahead_m + bench.camera.body_radius_m);
  const double hull_m = (bench.target.body_high_m - bench.target.body_low_m).norm() * bench.scale;
  target_reach_m_ = reach_of(bench.target_robot.design, bench.target.stand_off_m + hull_m);
}

ArmCapsules TestbedBodies::camera_arm_at(const Joints& joints_rad, double carriage_m) const {
  return arm_bodies(arms_.camera_arm(), arms_.T_L_camera_base(carriage_m), joints_rad, bench_.camera.ahead_m,
                    bench_.camera.body_radius_m, bench_);
}

ArmCapsules TestbedBodies::target_arm_at(const Joints& joints_rad) const {
  return arm_bodies(arms_.target_arm(), arms_.T_L_target_base(), joints_rad, bench_.target.stand_off_m,
                    bench_.target.rod_radius_m, bench_);
}

OrientedBox TestbedBodies::hull_at(const Eigen::Isometry3d& T_L_T) const {
  OrientedBox hull;
  hull.T_L_box = T_L_T;
  hull.T_L_box.translation() =
      T_L_T * Vector3(0.5 * bench_.scale * (bench_.target.body_low_m + bench_.target.body_high_m));
  hull.half_m = 0.5 * bench_.scale * (bench_.target.body_high_m - bench_.target.body_low_m);
  return hull;
}

Bodies TestbedBodies::at(const Posture& posture) const {
  Bodies bodies;
  bodies.camera_arm = camera_arm_at(posture.camera_rad, posture.carriage_m);
  bodies.target_arm = target_arm_at(posture.target_rad);
  bodies.T_L_C = arms_.camera_pose(posture);
  bodies.T_L_T = arms_.target_pose(posture);
  bodies.target = hull_at(bodies.T_L_T);
  return bodies;
}

bool TestbedBodies::is_in_room(const Vector3& point, double margin_m) const {
  return ((point - bench_.room_low_m).array() >= margin_m).all() &&
         ((bench_.room_high_m - point).array() >= margin_m).all();
}

TestbedBodies::Pair TestbedBodies::touching_of_arm(const ArmCapsules& arm,
                                                   const std::array<const char*, kArmBodies>& names,
                                                   double clearance_m) const {
  // The end of each body; its beginning is the end of the one before.
  for (std::size_t k = kFirstMoving; k < kArmBodies; ++k)
    if (!is_in_room(arm[k].to, arm[k].radius_m + clearance_m)) return {names[k], kRoom};
  for (const auto& [one, other] : kOwnPairs)
    if (are_near(arm[one], arm[other], clearance_m)) return {names[one], names[other]};
  return {};
}

TestbedBodies::Pair TestbedBodies::touching_of_target(const ArmCapsules& arm, const OrientedBox& hull,
                                                      double clearance_m) const {
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 signs((corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0, (corner & 4) != 0 ? 1.0 : -1.0);
    if (!is_in_room(hull.T_L_box * Vector3(signs.cwiseProduct(hull.half_m)), clearance_m)) return {kTarget, kRoom};
  }
  // The rod ends at the target, and the wrist before it points there.
  for (std::size_t k = kStand; k <= kForearm; ++k)
    if (are_near(arm[k], hull, clearance_m)) return {kTargetNames[k], kTarget};
  return {};
}

TestbedBodies::Pair TestbedBodies::touching_across(const ArmCapsules& camera_arm, const ArmCapsules& target_arm,
                                                   const OrientedBox& hull, double clearance_m) const {
  for (std::size_t k = 0; k < kArmBodies; ++k) {
    if (are_near(camera_arm[k], hull, clearance_m)) return {kCameraNames[k], kTarget};
    for (std::size_t n = 0; n < kArmBodies; ++n)
      if ((k >= kFirstMoving || n >= kFirstMoving) && are_near(camera_arm[k], target_arm[n], clearance_m))
        return {kCameraNames[k], kTargetNames[n]};
  }
  return {};
}

bool TestbedBodies::is_camera_arm_free(const ArmCapsules& arm) const {
  return touching_of_arm(arm, kCameraNames, clearance_m()).one == nullptr;
}

bool TestbedBodies::is_target_arm_free(const ArmCapsules& arm, const OrientedBox& hull) const {
  return touching_of_arm(arm, kTargetNames, clearance_m()).one == nullptr &&
         touching_of_target(arm, hull, clearance_m()).one == nullptr;
}

bool TestbedBodies::are_apart(const ArmCapsules& camera_arm, const ArmCapsules& target_arm,
                              const OrientedBox& hull) const {
  return touching_across(camera_arm, target_arm, hull, clearance_m()).one == nullptr;
}

std::string TestbedBodies::collision(const Bodies& bodies, double clearance_m) const {
  if (!bodies.T_L_C.matrix().allFinite() || !bodies.T_L_T.matrix().allFinite())
    return fmt::format("{} and {}", kNowhere, kRoom);
  Pair found = touching_of_arm(bodies.camera_arm, kCameraNames, clearance_m);
  if (found.one == nullptr) found = touching_of_arm(bodies.target_arm, kTargetNames, clearance_m);
  if (found.one == nullptr) found = touching_of_target(bodies.target_arm, bodies.target, clearance_m);
  if (found.one == nullptr) found = touching_across(bodies.camera_arm, bodies.target_arm, bodies.target, clearance_m);
  return found.one == nullptr ? std::string() : fmt::format("{} and {}", found.one, found.other);
}

std::string TestbedBodies::collision_between(const Posture& from, const Posture& to, double clearance_m,
                                             double step_m) const {
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
    if (const std::string found = collision(at(posture), clearance_m); !found.empty()) return found;
  }
  return {};
}

std::uint32_t TestbedBodies::hidden_by_camera_arm(const ArmCapsules& arm, const Vector3& eye,
                                                  std::span<const Vector3> points_L) {
  return hidden_by({arm.data(), kWrist}, eye, points_L);
}

std::uint32_t TestbedBodies::hidden_by_target_arm(const ArmCapsules& arm, const Vector3& eye,
                                                  std::span<const Vector3> points_L) {
  return hidden_by(arm, eye, points_L);
}

std::uint32_t TestbedBodies::shaded_by(const ArmCapsules& arm, const Vector3& towards_lamp,
                                       std::span<const Vector3> points_L) const {
  std::uint32_t mask = 0;
  for (std::size_t k = 0; k < points_L.size() && k < 32; ++k)
    mask |= hidden_by(arm, points_L[k] + bench_.lamp.radius_m * towards_lamp, points_L.subspan(k, 1)) << k;
  return mask;
}

std::vector<Vector3> TestbedBodies::lit_points(const OrientedBox& hull, const Vector3& towards_lamp) {
  constexpr double kTowardsCorner = 0.7;
  constexpr double kGrazing = 0.05;  // cosine below which the shadow on a face does not matter
  const Vector3 lamp_box = hull.T_L_box.linear().transpose() * towards_lamp;
  std::vector<Vector3> points;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(lamp_box[axis]) < kGrazing) continue;
    for (const auto& [u, v] : {std::pair(-1.0, -1.0), {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}) {
      Vector3 signs;
      signs[axis] = lamp_box[axis] > 0.0 ? 1.0 : -1.0;
      signs[(axis + 1) % 3] = kTowardsCorner * u;
      signs[(axis + 2) % 3] = kTowardsCorner * v;
      points.push_back(hull.T_L_box * Vector3(signs.cwiseProduct(hull.half_m)));
    }
  }
  return points;
}

int TestbedBodies::shaded(const Bodies& bodies, const Vector3& towards_lamp) const {
  const std::vector<Vector3> points = lit_points(bodies.target, towards_lamp);
  return std::popcount(shaded_by(bodies.camera_arm, towards_lamp, points) |
                       shaded_by(bodies.target_arm, towards_lamp, points));
}

std::vector<Vector3> TestbedBodies::points_at(const Eigen::Isometry3d& T_L_T,
                                              std::span<const Vector3> points_body) const {
  std::vector<Vector3> points;
  points.reserve(points_body.size());
  for (const Vector3& point : points_body) points.push_back(T_L_T * Vector3(bench_.scale * point));
  return points;
}

int TestbedBodies::hidden(const Bodies& bodies, std::span<const Vector3> points_body) const {
  const Vector3 eye = bodies.T_L_C.translation();
  const std::vector<Vector3> points = points_at(bodies.T_L_T, points_body);
  return std::popcount(hidden_by_camera_arm(bodies.camera_arm, eye, points) |
                       hidden_by_target_arm(bodies.target_arm, eye, points));
}

std::vector<Vector3> TestbedBodies::points_to_see(const std::filesystem::path& data_directory) const {
  std::vector<Vector3> points =
      mission::load_keypoints(mission::body_file_of(data_directory, bench_.target.model), fsw::pose::kKeypoints);
  points.emplace_back(0.5 * (bench_.target.body_low_m + bench_.target.body_high_m));
  return points;
}

}  // namespace vbar::tron
