#include "hil_drivers/tron/placement/candidates.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vbar::tron {
namespace {

constexpr double kSmallA5_rad = 6.0 * (std::numbers::pi / 180.0);
constexpr double kNearA1_m = 0.05;
/// Seconds at a limit or in a singularity; less in proportion at a distance.
constexpr double kPenalty_s = 1.0;

double shortage(double value, double wanted) {
  return wanted > 0.0 ? std::clamp(1.0 - value / wanted, 0.0, 1.0) : 0.0;
}

double penalty_of(const Arm& arm, const Joints& joints, double margin_rad) {
  double sum = shortage(std::abs(joints[4]), kSmallA5_rad) + shortage(arm.wrist_from_a1_m(joints), kNearA1_m);
  for (std::size_t k = 0; k < kJoints; ++k) {
    const double angle = joints[static_cast<Eigen::Index>(k)];
    const AxisLimits& axis = arm.design().axes[k];
    sum += shortage(std::min(angle - axis.lower, axis.upper - angle), margin_rad);
  }
  return kPenalty_s * sum;
}

}  // namespace

Candidates candidates(const Arm& arm, const Eigen::Isometry3d& T_base_flange, const Joints& from,
                      const CandidateRules& rules) {
  Candidates found;
  const Branches branches = arm.inverse(T_base_flange, from);
  const auto bears = [&](const Joints& joints) {
    return !rules.cable_turn_rad || std::abs(joints[3] + joints[5]) <= *rules.cable_turn_rad;
  };
  for (std::size_t k = 0; k < branches.count; ++k) {
    if (!branches.is_within_limits[k]) continue;
    std::optional<Joints> chosen = arm.nearest_turn(branches.joints[k], from);
    if (!bears(*chosen)) {
      chosen.reset();
      double nearest = 0.0;
      for (const Joints& turned : arm.turns(branches.joints[k])) {
        const double distance = (turned - from).lpNorm<Eigen::Infinity>();
        if (!bears(turned) || (chosen && distance >= nearest)) continue;
        chosen = turned;
        nearest = distance;
      }
    }
    if (!chosen) continue;
    found.all[found.count++] = {*chosen, penalty_of(arm, *chosen, rules.limit_margin_rad)};
  }
  return found;
}

}  // namespace vbar::tron
