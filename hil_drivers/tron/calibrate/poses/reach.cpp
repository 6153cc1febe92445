#include "hil_drivers/tron/calibrate/poses/reach.h"

#include <algorithm>
#include <vector>

namespace vbar::tron::calibrate {

Reach::Reach(const BenchFile& bench, double limit_margin_rad)
    : geometry_(bench), limit_margin_rad_(limit_margin_rad), T_B_T_(T_target_board(bench).inverse()) {}

std::optional<Posture> Reach::posture(const Eigen::Isometry3d& T_L_C, const Eigen::Isometry3d& T_L_B, double carriage_m,
                                      engine::RandomStream& random) const {
  const BenchFile& bench = geometry_.bench();
  if (carriage_m < bench.track.axis.lower || carriage_m > bench.track.axis.upper) return std::nullopt;
  const auto camera = joints(bench.camera_robot.design, geometry_.camera_flange(T_L_C, carriage_m), random);
  if (!camera) return std::nullopt;
  const auto target = joints(bench.target_robot.design, geometry_.target_flange(T_L_B * T_B_T_), random);
  if (!target) return std::nullopt;
  return Posture{*camera, *target, carriage_m};
}

std::optional<Joints> Reach::joints(const ArmDesign& arm, const Eigen::Isometry3d& T_base_flange,
                                    engine::RandomStream& random) const {
  std::vector<Joints> possible;
  for (const Branch& branch : inverse(arm, T_base_flange)) {
    const auto within = within_limits(arm, branch.joints_rad, Joints::Zero());
    if (!within) continue;
    bool is_clear = true;
    for (std::size_t k = 0; k < kJoints; ++k) {
      const double joint = (*within)[static_cast<Eigen::Index>(k)];
      is_clear =
          is_clear && joint > arm.axes[k].lower + limit_margin_rad_ && joint < arm.axes[k].upper - limit_margin_rad_;
    }
    if (is_clear) possible.push_back(*within);
  }
  if (possible.empty()) return std::nullopt;
  const auto count = static_cast<double>(possible.size());
  return possible[std::min(possible.size() - 1, static_cast<std::size_t>(count * random.uniform()))];
}

}  // namespace vbar::tron::calibrate
