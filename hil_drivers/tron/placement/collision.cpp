#include "hil_drivers/tron/placement/collision.h"

#include <algorithm>
#include <cmath>

#include "hil_drivers/tron/motion/joint_path.h"

namespace vbar::tron {
namespace {

using fsw::Vector3;

constexpr std::array<const char*, kArmLinks> kLinkNames{"column", "upper arm", "forearm", "wrist", "tool"};

ArmCapsules capsules(const ArmDesign& arm, const Eigen::Isometry3d& T_L_base, const Joints& joints,
                     const Vector3& tool_end, double tool_radius_m) {
  const ArmPoints points = arm_points(arm, joints);
  const auto at = [&](const Vector3& point) -> Vector3 { return T_L_base * point; };
  return {Capsule{at(Vector3::Zero()), at(points.shoulder), kColumnRadius_m},
          Capsule{at(points.shoulder), at(points.elbow), kUpperArmRadius_m},
          Capsule{at(points.forearm), at(points.wrist), kForearmRadius_m},
          Capsule{at(points.wrist), at(points.flange), kWristRadius_m},
          Capsule{at(points.flange), at(T_base_flange(arm, joints) * tool_end), tool_radius_m}};
}

/// Squared distance of two segments (Ericson 2005, "Real-time collision detection", section 5.1.9).
double segment_distance(const Vector3& p1, const Vector3& q1, const Vector3& p2, const Vector3& q2) {
  const Vector3 d1 = q1 - p1, d2 = q2 - p2, r = p1 - p2;
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), f = d2.dot(r), c = d1.dot(r), b = d1.dot(d2);
  constexpr double kPoint = 1e-18;
  double s = 0.0, t = 0.0;
  if (a > kPoint && e > kPoint) {
    const double denominator = a * e - b * b;
    if (denominator > 1e-12 * a * e) s = std::clamp((b * f - c * e) / denominator, 0.0, 1.0);
    t = (b * s + f) / e;
    if (t < 0.0 || t > 1.0) {
      t = std::clamp(t, 0.0, 1.0);
      s = std::clamp((b * t - c) / a, 0.0, 1.0);
    }
  } else if (a > kPoint) {
    s = std::clamp(-c / a, 0.0, 1.0);
  } else if (e > kPoint) {
    t = std::clamp(f / e, 0.0, 1.0);
  }
  return (p1 + s * d1 - p2 - t * d2).norm();
}

double point_box_distance(const Vector3& point, const Vector3& low, const Vector3& high) {
  return (point - point.cwiseMax(low).cwiseMin(high)).norm();
}

}  // namespace

ArmCapsules camera_arm_capsules(const Geometry& geometry, const Posture& posture) {
  const CameraMount& camera = geometry.bench().camera;
  return capsules(geometry.bench().camera_robot.design, geometry.T_L_camera_base(posture.carriage_m),
                  posture.camera_rad, camera.ahead_m * Vector3::UnitZ(), camera.body_radius_m);
}

ArmCapsules target_arm_capsules(const Geometry& geometry, const Posture& posture) {
  const TargetMount& target = geometry.bench().target;
  return capsules(geometry.bench().target_robot.design, geometry.T_L_target_base(), posture.target_rad,
                  target.stand_off_m * Vector3::UnitZ(), target.rod_radius_m);
}

double distance(const Capsule& a, const Capsule& b) {
  return segment_distance(a.from, a.to, b.from, b.to) - a.radius_m - b.radius_m;
}

double distance(const Capsule& a, const Eigen::Isometry3d& T_L_T, const Vector3& low_T, const Vector3& high_T) {
  const Eigen::Isometry3d T_T_L = T_L_T.inverse();
  const Vector3 from = T_T_L * a.from, to = T_T_L * a.to;
  // The distance from a convex body is convex along a line: golden sections.
  constexpr double kGolden = 0.6180339887498949;
  constexpr int kSections = 24;
  double low = 0.0, high = 1.0;
  const auto of = [&](double u) { return point_box_distance(from + u * (to - from), low_T, high_T); };
  double u = high - kGolden * (high - low), v = low + kGolden * (high - low);
  double at_u = of(u), at_v = of(v);
  for (int k = 0; k < kSections; ++k) {
    if (at_u < at_v) {
      high = v;
      v = u;
      at_v = at_u;
      u = high - kGolden * (high - low);
      at_u = of(u);
    } else {
      low = u;
      u = v;
      at_u = at_v;
      v = low + kGolden * (high - low);
      at_v = of(v);
    }
  }
  return std::max(0.0, std::min({at_u, at_v, of(0.0), of(1.0)}) - a.radius_m);
}

std::string CollisionCheck::conflict(const Posture& posture) const {
  const BenchFile& bench = geometry_.bench();
  const double clearance = bench.motion.clearance_m;
  const ArmCapsules camera = camera_arm_capsules(geometry_, posture), target = target_arm_capsules(geometry_, posture);
  const Eigen::Isometry3d T_L_T = geometry_.T_L_T(posture);
  const Vector3 low_T = bench.scale * bench.target.body_low_m, high_T = bench.scale * bench.target.body_high_m;
  const auto name = [](const char* arm, int link) {
    return std::string(kLinkNames[static_cast<std::size_t>(link)]) + " of the " + arm;
  };
  const auto in_room = [&](const Vector3& point, double radius_m) {
    const double margin = radius_m + clearance;
    return (point.array() >= bench.room_low_m.array() + margin).all() &&
           (point.array() <= bench.room_high_m.array() - margin).all();
  };
  // The column stands on floor or carriage by design.
  for (int k = kUpperArm; k < kArmLinks; ++k) {
    const Capsule &of_camera = camera[static_cast<std::size_t>(k)], &of_target = target[static_cast<std::size_t>(k)];
    if (!in_room(of_camera.to, of_camera.radius_m)) return name("camera's arm", k) + " and the room";
    if (!in_room(of_target.to, of_target.radius_m)) return name("target's arm", k) + " and the room";
  }
  const Vector3 middle = T_L_T * Vector3(0.5 * (low_T + high_T));
  const double hull = 0.5 * (high_T - low_T).norm();
  if (!in_room(middle, hull)) return "target and room";
  for (int i = 0; i < kArmLinks; ++i) {
    const Capsule& of_camera = camera[static_cast<std::size_t>(i)];
    if (distance(of_camera, T_L_T, low_T, high_T) < clearance) return name("camera's arm", i) + " and the target";
    for (int j = 0; j < kArmLinks; ++j)
      if (distance(of_camera, target[static_cast<std::size_t>(j)]) < clearance)
        return name("camera's arm", i) + " and " + name("target's arm", j);
  }
  // Links with at least one between them; rod and target touch by design.
  for (int i = 0; i < kArmLinks; ++i)
    for (int j = i + 2; j < kArmLinks; ++j) {
      // The wrist is at the end of the forearm: a bent one comes near it by design.
      if (i == kForearm) continue;
      if (distance(camera[static_cast<std::size_t>(i)], camera[static_cast<std::size_t>(j)]) < 0.0)
        return name("camera's arm", i) + " and its own " + kLinkNames[static_cast<std::size_t>(j)];
      if (distance(target[static_cast<std::size_t>(i)], target[static_cast<std::size_t>(j)]) < 0.0)
        return name("target's arm", i) + " and its own " + kLinkNames[static_cast<std::size_t>(j)];
    }
  for (int i = kColumn; i <= kForearm; ++i)
    if (distance(target[static_cast<std::size_t>(i)], T_L_T, low_T, high_T) < clearance)
      return name("target's arm", i) + " and the target";
  return "";
}

std::string CollisionCheck::conflict_on_way(const Posture& from, const Posture& to, double step_m) const {
  const AxisValues start = axis_values(from), way = axis_values(to) - start;
  // No point moves more than the sum of the turns, each times the farthest point from its axis.
  const auto travel_m = [](const ArmDesign& arm, double tool_m, const auto& turns) {
    const double hand = arm.d6_m + tool_m, fore = arm.a3_m + arm.d4_m + hand, all = arm.a1_m + arm.a2_m + fore;
    const std::array<double, kJoints> reach{all, arm.a2_m + fore, fore, hand, hand, hand};
    double sum = 0.0;
    for (std::size_t k = 0; k < kJoints; ++k) sum += std::abs(turns(static_cast<Eigen::Index>(k))) * reach[k];
    return sum;
  };
  const BenchFile& bench = geometry_.bench();
  const double target_m = bench.target.stand_off_m + bench.scale * bench.target.body_high_m.norm();
  const double most_m =
      std::max(travel_m(bench.camera_robot.design, bench.camera.ahead_m, way.head<6>()) + std::abs(way(12)),
               travel_m(bench.target_robot.design, target_m, way.segment<6>(6)));
  const int steps = std::max(1, static_cast<int>(std::ceil(most_m / step_m)));
  for (int k = 1; k <= steps; ++k) {
    std::string found = conflict(posture_of(start + static_cast<double>(k) / steps * way));
    if (!found.empty()) return found;
  }
  return "";
}

std::vector<Posture> CollisionCheck::free_way(const Posture& from, const Posture& to) const {
  if (conflict_on_way(from, to).empty()) return {from, to};
  const BenchFile& bench = geometry_.bench();
  const auto home = [](const Robot& robot, const Joints& at) {
    Joints joints = at;
    // Wrist and column may stay: what brings an arm out of the way is its elbow.
    for (const std::size_t k : {1U, 2U}) joints(static_cast<Eigen::Index>(k)) = robot.home_rad[k];
    return joints;
  };
  const Posture middle = posture_of(0.5 * (axis_values(from) + axis_values(to)));
  for (const Posture& about : {middle, from, to}) {
    for (const bool is_camera_retracted : {false, true}) {
      Posture corner = middle;
      corner.target_rad = home(bench.target_robot, about.target_rad);
      if (is_camera_retracted) corner.camera_rad = home(bench.camera_robot, about.camera_rad);
      if (conflict_on_way(from, corner).empty() && conflict_on_way(corner, to).empty()) return {from, corner, to};
    }
  }
  return {};
}

int hidden_points(const Geometry& geometry, const Posture& posture, const std::vector<Vector3>& points_T) {
  const Vector3 camera = geometry.T_L_C(posture).translation();
  const Eigen::Isometry3d T_L_T = geometry.T_L_T(posture);
  const ArmCapsules arm = target_arm_capsules(geometry, posture);
  return static_cast<int>(std::ranges::count_if(points_T, [&](const Vector3& point) {
    const Capsule sight{camera, T_L_T * point, 0.0};
    return std::ranges::any_of(arm, [&](const Capsule& link) { return distance(sight, link) < 0.0; });
  }));
}

}  // namespace vbar::tron
