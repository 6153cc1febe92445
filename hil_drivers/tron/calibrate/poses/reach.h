#pragma once
// Joints for poses of camera and board in the laboratory, by the testbed as designed.

#include <optional>

#include "hil_drivers/tron/calibrate/board/board_design.h"
#include "hil_drivers/tron/kinematics/arm_pair.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::tron::calibrate {

class Reach {
 public:
  /// Keeps all branches `limit_margin_rad` from the limits of their axes.
  Reach(const BenchFile& bench, double limit_margin_rad);

  /// Returns one of the branches that are within the limits, drawn at random.
  [[nodiscard]] std::optional<Posture> posture(const Eigen::Isometry3d& T_L_C, const Eigen::Isometry3d& T_L_B,
                                               double carriage_m, engine::RandomStream& random) const;

 private:
  [[nodiscard]] std::optional<Joints> joints(const Arm& arm, const Eigen::Isometry3d& T_base_flange,
                                             engine::RandomStream& random) const;

  ArmPair arms_;
  AxisLimits track_;
  double limit_margin_rad_;
  Eigen::Isometry3d T_B_T_;
};

}  // namespace vbar::tron::calibrate
