#include "hil_drivers/tron/placement/placement.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "hil_drivers/tron/motion/joint_path.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::tron {
namespace {

using fsw::Matrix3;
using fsw::Vector3;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kParallel_rad = 5.0 * kDegree;  // of Sun and line of sight: the turn about it is then free
constexpr double kMostSunError_rad = 0.5 * kDegree;

// Ranges of the free parameters, and the spread of trials near the last placement.
constexpr double kFromBeam_m = 0.25, kYaw_rad = 40.0 * kDegree, kPitch_rad = 25.0 * kDegree, kCarriage_m = 0.8;
constexpr double kNear_m = 0.08, kNear_rad = 4.0 * kDegree;

double angle_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Right-handed triad of z and of the part of x_reference square to it.
Matrix3 triad(const Vector3& z, const Vector3& x_reference) {
  Matrix3 R;
  R.col(2) = z.normalized();
  R.col(0) = (x_reference - x_reference.dot(R.col(2)) * R.col(2)).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

/// Largest yaw and pitch at which the camera is still in the room, half of whose width and height it can use.
struct Turns {
  double yaw_rad, pitch_rad;
};
Turns largest_turns(const BenchFile& bench, double range_m) {
  const auto turn = [range_m](double half_m, double most_rad) {
    return half_m < range_m ? std::min(most_rad, std::asin(half_m / range_m)) : most_rad;
  };
  return {turn(0.5 * (bench.room_high_m.y() - bench.room_low_m.y()), kYaw_rad),
          turn(0.5 * (bench.room_high_m.z() - bench.room_low_m.z()), kPitch_rad)};
}

FreePlace anywhere(engine::RandomStream& random, const Vector3& beam_L, const Turns& most) {
  FreePlace free;
  for (Eigen::Index k = 0; k < 3; ++k) free.target_L(k) = beam_L(k) + random.uniform(-kFromBeam_m, kFromBeam_m);
  free.yaw_rad = random.uniform(-most.yaw_rad, most.yaw_rad);
  free.pitch_rad = random.uniform(-most.pitch_rad, most.pitch_rad);
  free.carriage_offset_m = random.uniform(-kCarriage_m, kCarriage_m);
  return free;
}

FreePlace near(const FreePlace& last, engine::RandomStream& random, const Vector3& beam_L) {
  FreePlace free;
  const auto about = [&random](double value, double sigma, double middle, double reach) {
    return std::clamp(value + sigma * random.normal(), middle - reach, middle + reach);
  };
  for (Eigen::Index k = 0; k < 3; ++k) free.target_L(k) = about(last.target_L(k), kNear_m, beam_L(k), kFromBeam_m);
  free.yaw_rad = about(last.yaw_rad, kNear_rad, 0.0, kYaw_rad);
  free.pitch_rad = about(last.pitch_rad, kNear_rad, 0.0, kPitch_rad);
  free.carriage_offset_m = about(last.carriage_offset_m, kNear_m, 0.0, kCarriage_m);
  return free;
}

struct LampPlace {
  double azimuth_rad = 0.0;
  double error_rad = 0.0;
};

/// cos(pitch) cos(b - yaw) = cos(phase angle), on the arc; the nearer of two solutions to `last_rad`.
std::optional<LampPlace> lamp_place(const Lamp& lamp, double yaw_rad, double pitch_rad, double phase_rad) {
  const double cosine = std::cos(phase_rad) / std::cos(pitch_rad);
  const double half = std::acos(std::clamp(cosine, -1.0, 1.0));
  std::optional<LampPlace> best;
  for (const double azimuth : {yaw_rad + half, yaw_rad - half}) {
    const double on_arc = std::clamp(azimuth, lamp.azimuth_low_rad, lamp.azimuth_high_rad);
    const double reached = std::acos(std::clamp(std::cos(pitch_rad) * std::cos(on_arc - yaw_rad), -1.0, 1.0));
    const double error = std::abs(reached - phase_rad);
    if (error <= kMostSunError_rad && (!best || error < best->error_rad)) best = {on_arc, error};
  }
  return best;
}

}  // namespace

std::string NoPlacement::reason() const {
  return fmt::format(
      "no placement of arms and lamp: refused for the lamp {}, reach {}, collisions {}, hidden points {}", lamp, reach,
      collision, hidden);
}

PlacementSearch::PlacementSearch(const Geometry& geometry, const PlacementSettings& settings,
                                 std::vector<Vector3> points_T)
    : geometry_(geometry),
      settings_(settings),
      points_T_(std::move(points_T)),
      collisions_(geometry),
      limits_(motion_limits(geometry.bench())) {}

std::optional<Placement> PlacementSearch::at(const FreePlace& free, const Scene& scene, const Posture& from,
                                             NoPlacement& refused) const {
  const BenchFile& bench = geometry_.bench();
  const Vector3 middle_T = points_T_.back();
  const Vector3 middle_C = scene.T_C_T * middle_T;
  const Vector3 to_camera_L(-std::cos(free.pitch_rad) * std::cos(free.yaw_rad),
                            -std::cos(free.pitch_rad) * std::sin(free.yaw_rad), std::sin(free.pitch_rad));
  const double phase_rad = angle_between(-middle_C, scene.sun_C);
  Placement found;
  found.free = free;
  const bool is_free = phase_rad < kParallel_rad || phase_rad > std::numbers::pi - kParallel_rad;
  Vector3 x_C = scene.sun_C, x_L;
  if (scene.sunlit > 0.0) {
    const auto lamp = lamp_place(bench.lamp, free.yaw_rad, free.pitch_rad, phase_rad);
    if (!lamp) {
      ++refused.lamp;
      return std::nullopt;
    }
    found.lamp_azimuth_rad = lamp->azimuth_rad;
    found.sun_error_rad = lamp->error_rad;
    x_L = Lamp::direction(lamp->azimuth_rad);
  } else {
    found.lamp_azimuth_rad = 0.5 * (bench.lamp.azimuth_low_rad + bench.lamp.azimuth_high_rad);
  }
  if (is_free || scene.sunlit <= 0.0) {
    // The camera stays as it is turned.
    x_C = Vector3::UnitX();
    x_L = geometry_.T_L_C(from).linear() * x_C;
  }
  Eigen::Isometry3d T_L_C = Eigen::Isometry3d::Identity();
  T_L_C.linear() = triad(-to_camera_L, x_L) * triad(middle_C, x_C).transpose();
  T_L_C.translation() = free.target_L - T_L_C.linear() * middle_C;
  const double carriage_m =
      std::clamp(T_L_C.translation().x() + free.carriage_offset_m, bench.track.axis.lower, bench.track.axis.upper);

  // Each arm on the branch that costs least.
  const auto best_joints = [&](const ArmDesign& arm, const Eigen::Isometry3d& flange, const Joints& near,
                               bool is_camera) {
    std::optional<Joints> best;
    double least_s = 0.0;
    for (const Branch& branch : inverse(arm, flange)) {
      const auto joints = within_limits(arm, branch.joints_rad, near);
      if (!joints) continue;
      Posture posture = from;
      (is_camera ? posture.camera_rad : posture.target_rad) = *joints;
      if (is_camera && !cable_allows(posture)) continue;
      const double cost_s = move_time_s(limits_, from, posture) + penalty_s(posture);
      if (!best || cost_s < least_s) {
        best = joints;
        least_s = cost_s;
      }
    }
    return best;
  };
  const auto target =
      best_joints(bench.target_robot.design, geometry_.target_flange(T_L_C * scene.T_C_T), from.target_rad, false);
  const auto camera =
      target ? best_joints(bench.camera_robot.design, geometry_.camera_flange(T_L_C, carriage_m), from.camera_rad, true)
             : std::nullopt;
  if (!camera) {
    ++refused.reach;
    return std::nullopt;
  }
  found.posture = {*camera, *target, carriage_m};
  found.move_s = move_time_s(limits_, from, found.posture);
  found.cost_s = found.move_s + penalty_s(found.posture);
  return found;
}

/// Postures near a limit or a singularity cost time: the correction after the move could need more than they have.
double PlacementSearch::penalty_s(const Posture& posture) const {
  constexpr double kWrist_rad = 6.0 * kDegree, kShoulder_m = 0.05, kNear_s = 1.0, kSingular_s = 4.0;
  const BenchFile& bench = geometry_.bench();
  double sum = 0.0;
  const auto add = [&](const ArmDesign& arm, const Joints& joints) {
    for (std::size_t k = 0; k < kJoints; ++k) {
      const double angle = joints(static_cast<Eigen::Index>(k));
      const double left = std::min(angle - arm.axes[k].lower, arm.axes[k].upper - angle);
      if (left < bench.motion.limit_margin_rad) sum += kNear_s * (1.0 - left / bench.motion.limit_margin_rad);
    }
    if (std::abs(joints(4)) < kWrist_rad) sum += kSingular_s * (1.0 - std::abs(joints(4)) / kWrist_rad);
    if (const double radius_m = wrist_radius(arm, joints); radius_m < kShoulder_m)
      sum += kSingular_s * (1.0 - radius_m / kShoulder_m);
  };
  add(bench.camera_robot.design, posture.camera_rad);
  add(bench.target_robot.design, posture.target_rad);
  return sum;
}

bool PlacementSearch::cable_allows(const Posture& posture) const {
  const Robot& robot = geometry_.bench().camera_robot;
  const double turned = posture.camera_rad(3) + posture.camera_rad(5) - robot.home_rad[3] - robot.home_rad[5];
  return std::abs(turned) <= geometry_.bench().motion.cable_turn_rad;
}

/// The best of the candidates, in the order of their cost, that is free and hides little, unless `best` is better.
void PlacementSearch::choose(std::vector<Placement>& candidates, const Posture& from, std::optional<Placement>& best,
                             NoPlacement& refused) const {
  std::ranges::stable_sort(candidates, {}, &Placement::cost_s);
  for (Placement& candidate : candidates) {
    // Nothing that follows can be better.
    if (best && candidate.cost_s >= best->cost_s) return;
    if (!collisions_.conflict(candidate.posture).empty()) {
      ++refused.collision;
      continue;
    }
    candidate.hidden = hidden_points(geometry_, candidate.posture, points_T_);
    if (candidate.hidden > settings_.max_hidden) {
      ++refused.hidden;
      continue;
    }
    candidate.cost_s += settings_.hidden_cost_s * candidate.hidden;
    if (best && candidate.cost_s >= best->cost_s) continue;
    candidate.way = collisions_.free_way(from, candidate.posture);
    if (candidate.way.empty()) {
      ++refused.collision;
      continue;
    }
    if (candidate.way.size() > 2) {
      const double straight_s = candidate.move_s;
      candidate.move_s = 0.0;
      for (std::size_t k = 1; k < candidate.way.size(); ++k)
        candidate.move_s += move_time_s(limits_, candidate.way[k - 1], candidate.way[k]);
      candidate.cost_s += candidate.move_s - straight_s;
      if (best && candidate.cost_s >= best->cost_s) continue;
    }
    best = candidate;
  }
}

std::variant<Placement, NoPlacement> PlacementSearch::find(const Scene& scene, const Posture& from,
                                                           std::int64_t number) {
  const Vector3& beam_L = geometry_.bench().lamp.centre_m;
  engine::RandomStream random(settings_.seed, fmt::format("tron/placement/{}", number));
  NoPlacement refused;
  std::optional<Placement> best;
  std::vector<Placement> candidates;
  const Turns most = largest_turns(geometry_.bench(), scene.T_C_T.translation().norm());
  for (int round = 0; round < settings_.rounds && (!best || best->hidden > 0); ++round) {
    candidates.clear();
    for (int k = 0; k < settings_.trials; ++k) {
      // Where the neighbourhood of the last placement has nothing clear, it is of no use.
      const bool is_near = last_.has_value() && round == 0 && k % 3 != 0;
      const FreePlace free = k == 1 && is_near ? *last_
                             : is_near         ? near(*last_, random, beam_L)
                                               : anywhere(random, beam_L, most);
      if (const auto found = at(free, scene, from, refused)) candidates.push_back(*found);
    }
    choose(candidates, from, best, refused);
  }
  if (!best) return refused;
  last_ = best->free;
  return *best;
}

std::vector<Vector3> points_of_target(const BenchFile& bench, const std::vector<Vector3>& keypoints_m) {
  std::vector<Vector3> points_T;
  for (const Vector3& keypoint : keypoints_m) points_T.push_back(bench.scale * keypoint);
  points_T.push_back(bench.scale * 0.5 * (bench.target.body_low_m + bench.target.body_high_m));
  return points_T;
}

}  // namespace vbar::tron
