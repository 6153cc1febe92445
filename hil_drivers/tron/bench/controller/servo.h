#pragma once
// Drives of seven axes: second order, critically damped, so that a command is followed without overshoot and a ramp
// with a constant lag of 8 ms. The command is interpolated between cycles. A robot that is stopped brakes each axis at
// its own acceleration.

#include <array>

#include "hil_drivers/tron/rsi/client/axis_positions.h"

namespace vbar::tron::bench {

using rsi::AxisPositions;

inline constexpr std::size_t kServoAxes = 7;       ///< A1 to A6, E1
inline constexpr std::size_t kTrackAxis = 6;       ///< E1
using AxisArray = std::array<double, kServoAxes>;  ///< rad; m from home of E1

[[nodiscard]] AxisArray to_array(const AxisPositions& positions);
[[nodiscard]] AxisPositions to_positions(const AxisArray& values);

class Servo {
 public:
  inline static constexpr double kLag_s = 0.008;

  /// Begins at `start`. `deceleration` of the braking: rad/s2 (m/s2).
  Servo(const AxisArray& start, const AxisArray& deceleration, double cycle_s);

  /// Moves for one cycle, in which the command moves to `command`.
  void follow(const AxisArray& command);
  /// Brakes for one cycle from the velocity that the command has; at rest: holds.
  void brake();

  [[nodiscard]] const AxisArray& position() const { return position_; }
  /// Returns the position that is commanded, the braking distance so far included.
  [[nodiscard]] const AxisArray& command() const { return command_; }
  /// Returns true if no axis is more than 1e-7 rad (m) from a command that does not move.
  [[nodiscard]] bool stands() const;

 private:
  void step(const AxisArray& command);

  AxisArray position_, velocity_{}, command_, command_velocity_{}, deceleration_;
  double cycle_s_;
};

}  // namespace vbar::tron::bench
