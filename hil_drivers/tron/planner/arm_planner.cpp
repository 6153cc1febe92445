#include "hil_drivers/tron/planner/arm_planner.h"

#include <memory>

#include "hil_drivers/tron/motion/joint_path.h"

namespace vbar::tron {

Motion motion_along(const BenchFile& bench, const std::vector<Posture>& corners) {
  const auto path = std::make_shared<const JointPath>(bench, corners);
  Motion motion;
  motion.cycles = path->cycles();
  motion.at = [path](int cycle) { return path->at(cycle); };
  motion.stop_after = [path](int cycle) {
    const auto postures = std::make_shared<const std::vector<Posture>>(path->stop_after(cycle));
    Motion stop;
    stop.cycles = static_cast<int>(postures->size());
    stop.at = [postures](int k) { return postures->at(static_cast<std::size_t>(k - 1)); };
    return stop;
  };
  return motion;
}

ArmPlanner::ArmPlanner(const BenchFile& bench, const Calibration& calibration, const PlacementSettings& settings,
                       const std::vector<fsw::Vector3>& keypoints_m)
    : calibration_(calibration),
      geometry_(bench),
      collisions_(geometry_),
      search_(geometry_, settings, points_of_target(bench, keypoints_m)) {}

std::variant<Place, NoPlace> ArmPlanner::place(const Scene& scene, const Posture& from, std::int64_t image) {
  const auto found = search_.find(scene, from, image);
  if (const auto* const none = std::get_if<NoPlacement>(&found)) return NoPlace{none->reason()};
  const auto& placement = std::get<Placement>(found);
  return Place{placement.posture, placement.lamp_azimuth_rad, placement.sun_error_rad, placement.hidden};
}

std::variant<Motion, NoPlace> ArmPlanner::path(const Posture& from, const Posture& to) {
  const std::vector<Posture> way = collisions_.free_way(from, to);
  if (way.empty()) return NoPlace{"no way of the arms that is free of collisions"};
  return motion_along(geometry_.bench(), way);
}

std::optional<Posture> ArmPlanner::corrected(const Posture& from, const Eigen::Isometry3d& T_C_T) {
  // The calibrated arms differ from the designed ones by a pose that hardly changes with the posture: the designed ones
  // are sent to where this difference leads to the wanted pose, and again with the difference found there.
  constexpr int kIterations = 8;
  constexpr double kReached_m = 1e-6, kReached_rad = 1e-6;
  Posture at = from;
  for (int k = 0; k < kIterations; ++k) {
    const Eigen::Isometry3d left = T_C_T_of_arms(calibration_, at).inverse() * T_C_T;
    if (left.translation().norm() < kReached_m && Eigen::AngleAxisd(left.linear()).angle() < kReached_rad) return at;
    const auto next = geometry_.with_relative_pose(at, geometry_.T_C_T(at) * left);
    if (!next) return std::nullopt;
    at = *next;
  }
  return at;
}

}  // namespace vbar::tron
