#include "hil_drivers/tron/motion/path_planner.h"

#include <cmath>

#include <fmt/format.h>

namespace vbar::tron {
namespace {

/// A posture may be this much beyond a limit by rounding, and the cable turned this much farther by a correction.
constexpr double kLimitRounding = 1e-6;
constexpr double kCableCorrection_rad = 0.035;
/// Share of the clearance that is kept at a corrected posture.
constexpr double kCorrectedClearance = 0.5;

bool is_within(const Arm& arm, const Joints& joints) {
  for (std::size_t k = 0; k < kJoints; ++k) {
    const double angle = joints[static_cast<Eigen::Index>(k)];
    const AxisLimits& axis = arm.design().axes[k];
    if (angle < axis.lower - kLimitRounding || angle > axis.upper + kLimitRounding) return false;
  }
  return true;
}

}  // namespace

PathPlanner::PathPlanner(const BenchFile& bench, const BenchBodies& bodies)
    : bodies_(bodies),
      limits_(bench),
      track_(bench.track.axis),
      camera_home_(Joints::Map(bench.camera_robot.home_rad.data())),
      target_home_(Joints::Map(bench.target_robot.home_rad.data())),
      cable_turn_rad_(bench.motion.cable_turn_rad),
      cycle_s_(bench.motion.cycle_s) {}

std::string PathPlanner::refusal_of(const Posture& posture) const {
  if (!is_finite(posture)) return "is not finite";
  if (!is_within(bodies_.arms().camera_arm(), posture.camera_rad)) return "is beyond a limit of the camera's arm";
  if (!is_within(bodies_.arms().target_arm(), posture.target_rad)) return "is beyond a limit of the target's arm";
  if (posture.carriage_m < track_.lower - kLimitRounding || posture.carriage_m > track_.upper + kLimitRounding)
    return "is beyond the track";
  const double turned = std::abs(posture.camera_rad[3] + posture.camera_rad[5]);
  if (turned > cable_turn_rad_ + kCableCorrection_rad) return "twists the cable of the camera too far";
  return {};
}

double PathPlanner::clearance_for(const Posture& from, const Posture& to) const {
  const double clearance_m = bodies_.clearance_m();
  const bool is_kept = bodies_.is_free(bodies_.at(from)) && bodies_.is_free(bodies_.at(to));
  return is_kept ? clearance_m : kCorrectedClearance * clearance_m;
}

bool PathPlanner::is_straight_free(const Posture& from, const Posture& to) const {
  return bodies_.collision_between(from, to, clearance_for(from, to)).empty();
}

Path PathPlanner::through(const Posture& from, const std::vector<Posture>& postures) const {
  Path path(from);
  for (const Posture& posture : postures) path.go_to(posture, limits_, cycle_s_);
  return path;
}

std::variant<Path, NoPath> PathPlanner::plan(const Posture& from, const Posture& to) const {
  // Where the arms stand is a fact, also if it is a little beyond a limit.
  if (!is_finite(from)) return NoPath{"the posture at the start of a path is not finite"};
  if (const std::string refusal = refusal_of(to); !refusal.empty())
    return NoPath{fmt::format("the posture at the end of a path {}", refusal)};
  const double clearance_m = clearance_for(from, to);
  for (const auto& [posture, name] : {std::pair(&from, "start"), std::pair(&to, "end")})
    if (const std::string found = bodies_.collision(bodies_.at(*posture), clearance_m); !found.empty())
      return NoPath{fmt::format("at the {} of a path {} are closer than {:.0f} mm", name, found, 1e3 * clearance_m)};
  const std::string blocked = bodies_.collision_between(from, to, clearance_m);
  // |A4 + A6| is at most the larger of its ends on a straight line, so the cable needs no samples.
  if (blocked.empty()) return through(from, {to});

  const std::vector<std::vector<Posture>> detours{
      {{from.camera_rad, target_home_, from.carriage_m}, {to.camera_rad, target_home_, to.carriage_m}, to},
      {{camera_home_, from.target_rad, from.carriage_m}, {camera_home_, to.target_rad, to.carriage_m}, to},
      {{camera_home_, target_home_, from.carriage_m}, {camera_home_, target_home_, to.carriage_m}, to},
      // One arm after the other.
      {{camera_home_, from.target_rad, from.carriage_m},
       {camera_home_, target_home_, to.carriage_m},
       {camera_home_, to.target_rad, to.carriage_m},
       to},
      {{from.camera_rad, target_home_, from.carriage_m},
       {camera_home_, target_home_, to.carriage_m},
       {to.camera_rad, target_home_, to.carriage_m},
       to},
  };
  std::variant<Path, NoPath> best = NoPath{
      fmt::format("the path is blocked: {} would be closer than the clearance, also over retracted postures", blocked)};
  for (const auto& detour : detours) {
    Path path = through(from, detour);
    if (const Path* found = std::get_if<Path>(&best); found != nullptr && found->cycles() <= path.cycles()) continue;
    bool is_free = true;
    const Posture* last = &from;
    for (const Posture& posture : detour) {
      is_free = is_free && bodies_.collision_between(*last, posture, clearance_m).empty();
      last = &posture;
    }
    if (is_free) best = std::move(path);
  }
  return best;
}

}  // namespace vbar::tron
