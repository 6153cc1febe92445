#include "hil_drivers/tron/calibrate/poses/reach.h"

#include <algorithm>
#include <vector>

namespace vbar::tron::calibrate {

Reach::Reach(const BenchFile& bench, double limit_margin_rad)
    : arms_(bench),
      track_(bench.track.axis),
      limit_margin_rad_(limit_margin_rad),
      T_B_T_(T_target_board(bench).inverse()) {}

std::optional<Posture> Reach::posture(const Eigen::Isometry3d& T_L_C, const Eigen::Isometry3d& T_L_B, double carriage_m,
                                      engine::RandomStream& random) const {
  if (carriage_m < track_.lower || carriage_m > track_.upper) return std::nullopt;
  const auto camera = joints(arms_.camera_arm(), arms_.camera_flange(T_L_C, carriage_m), random);
  if (!camera) return std::nullopt;
  const auto target = joints(arms_.target_arm(), arms_.target_flange(T_L_B * T_B_T_), random);
  if (!target) return std::nullopt;
  return Posture{*camera, *target, carriage_m};
}

std::optional<Joints> Reach::joints(const Arm& arm, const Eigen::Isometry3d& T_base_flange,
                                    engine::RandomStream& random) const {
  const Branches branches = arm.inverse(T_base_flange);
  std::vector<Joints> possible;
  for (std::size_t branch = 0; branch < branches.count; ++branch) {
    if (!branches.is_within_limits[branch]) continue;
    const Joints& joints = branches.joints[branch];
    bool is_clear = true;
    for (std::size_t k = 0; k < kJoints; ++k) {
      const double joint = joints[static_cast<Eigen::Index>(k)];
      const AxisLimits& axis = arm.design().axes[k];
      is_clear = is_clear && joint > axis.lower + limit_margin_rad_ && joint < axis.upper - limit_margin_rad_;
    }
    if (is_clear) possible.push_back(joints);
  }
  if (possible.empty()) return std::nullopt;
  const auto count = static_cast<double>(possible.size());
  return possible[std::min(possible.size() - 1, static_cast<std::size_t>(count * random.uniform()))];
}

}  // namespace vbar::tron::calibrate
