#pragma once
// Paths free of collisions: straight in joint space, or over a retracted posture.

#include <string>
#include <variant>
#include <vector>

#include "hil_drivers/tron/collision/bench_bodies.h"
#include "hil_drivers/tron/motion/path.h"

namespace vbar::tron {

/// States why there is no path, one sentence.
struct NoPath {
  std::string reason;
};

class PathPlanner {
 public:
  /// `bodies` must outlive the planner.
  PathPlanner(const BenchFile& bench, const BenchBodies& bodies);

  [[nodiscard]] const AxisLimitsOfBench& limits() const { return limits_; }

  /// Returns the straight path if it is free, else the fastest free detour: one arm or both go to their home posture
  /// first. An end beyond limits, in collision or not finite has no path. A corrected posture may be closer than the
  /// clearance: from and to one, half the clearance is kept.
  [[nodiscard]] std::variant<Path, NoPath> plan(const Posture& from, const Posture& to) const;
  /// Returns true if the straight path is free.
  [[nodiscard]] bool is_straight_free(const Posture& from, const Posture& to) const;

 private:
  [[nodiscard]] std::string refusal_of(const Posture& posture) const;
  [[nodiscard]] double clearance_for(const Posture& from, const Posture& to) const;
  [[nodiscard]] Path through(const Posture& from, const std::vector<Posture>& postures) const;

  const BenchBodies& bodies_;
  AxisLimitsOfBench limits_;
  AxisLimits track_;
  Joints camera_home_, target_home_;
  double cable_turn_rad_, cycle_s_;
};

}  // namespace vbar::tron
