#pragma once
// A path of straight lines in joint space, for every robot cycle: all thirteen axes move in the proportion of one path
// parameter, rest to rest in each line. A stop slows the parameter down, so that the arms stay on the path.

#include <vector>

#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/kinematics/posture.h"
#include "hil_drivers/tron/motion/s_curve.h"

namespace vbar::tron {

inline constexpr int kAxes = 13;                     ///< A1 to A6 of the camera's arm and of the target's, carriage
using AxisValues = Eigen::Matrix<double, kAxes, 1>;  ///< rad; m of the carriage
[[nodiscard]] AxisValues axis_values(const Posture& posture);
[[nodiscard]] Posture posture_of(const AxisValues& values);

/// In the order of AxisValues; speed, acceleration and jerk times the override.
[[nodiscard]] std::vector<AxisLimits> motion_limits(const BenchFile& bench);

class JointPath {
 public:
  /// Through these postures, of which there is at least one.
  JointPath(const BenchFile& bench, const std::vector<Posture>& postures);

  [[nodiscard]] int cycles() const { return cycles_; }
  [[nodiscard]] double duration_s() const { return cycles_ * cycle_s_; }
  /// From 0, the start, to cycles(), the end; before and after at rest.
  [[nodiscard]] Posture at(int cycle) const;

  /// Where the arms are in the cycles after `cycle` if they stop as soon as the accelerations that are left allow: the
  /// last one is at rest. Empty at rest.
  [[nodiscard]] std::vector<Posture> stop_after(int cycle) const;

 private:
  struct Line {
    AxisValues from, way;
    SCurve curve;
    int first_cycle, cycles;
    double stretch;  ///< of time, to whole cycles
  };
  [[nodiscard]] const Line& line_at(double cycle) const;
  [[nodiscard]] Posture at(double cycle) const;

  std::vector<AxisLimits> limits_;
  double cycle_s_;
  AxisValues start_;
  std::vector<Line> lines_;
  int cycles_ = 0;
};

/// Duration of a line between two postures, s.
[[nodiscard]] double move_time_s(const std::vector<AxisLimits>& limits, const Posture& from, const Posture& to);

}  // namespace vbar::tron
