#pragma once
// Software limits, speed and acceleration of the commands to the axes, which switch the drives off. Speed and
// acceleration are judged on commands of successive cycles; after a gap only the mean speed over it is, as if it had
// lasted three cycles at most.

#include <array>
#include <string>

#include "hil_drivers/tron/bench/controller/servo.h"
#include "hil_drivers/tron/bench_file/bench_file.h"

namespace vbar::tron::bench {

class AxisMonitor {
 public:
  /// Takes limits in the coordinates of AxisArray.
  AxisMonitor(const std::array<AxisLimits, kServoAxes>& limits, double cycle_s) : limits_(limits), cycle_s_(cycle_s) {}

  /// Begins with the axes at `start`.
  void begin(const AxisArray& start);
  /// Returns the message that switches the drives off, or empty. `cycles`: since the last command.
  [[nodiscard]] std::string judge(const AxisArray& command, int cycles);

  [[nodiscard]] const AxisArray& max_speed() const { return max_speed_; }
  [[nodiscard]] const AxisArray& max_acceleration() const { return max_acceleration_; }

 private:
  std::string judge_axis(std::size_t axis, double command, int cycles);

  std::array<AxisLimits, kServoAxes> limits_;
  double cycle_s_;
  AxisArray last_{}, speed_{}, max_speed_{}, max_acceleration_{};
  bool has_speed_ = true;
};

}  // namespace vbar::tron::bench
