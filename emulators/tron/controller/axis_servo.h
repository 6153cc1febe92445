#pragma once
// Drives of seven axes: second order, critically damped, so that a command is followed without overshoot and a ramp
// with a constant lag of 8 ms. The command is interpolated between cycles. A robot that is stopped brakes each axis at
// its own acceleration.

#include <array>
#include <string>

#include "hil_drivers/tron/geometry/testbed_design.h"
#include "hil_drivers/tron/protocols/rsi_client.h"
#include "hil_drivers/tron/protocols/rsi_messages.h"

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

// Software limits, speed and acceleration of the commands to the axes, which switch the drives off. Speed and
// acceleration are judged on commands of successive cycles; after a gap only the mean speed over it is, as if it had
// lasted three cycles at most.

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

// Conversion of the answers of the computer to commands of the axes: values that hold or fall to zero, silent clamping,
// and the overall monitor.

class Correction {
 public:
  Correction(const rsi::EthernetXml& ethernet, const rsi::ContextXml& context);

  /// Begins at RSI_ON: all values are zero, and count from `pose`.
  void begin(const AxisArray& pose);
  /// Sets the values of this cycle: those of the answer, or nullptr if there is no valid one.
  void take(const rsi::Sen* answer);

  [[nodiscard]] const AxisArray& command() const { return command_; }
  [[nodiscard]] bool was_clamped() const { return was_clamped_; }
  /// Returns true if Stop has changed from 0 to 1.
  [[nodiscard]] bool stop_rises() const { return stop_rises_; }
  /// Names the axis whose overall correction is beyond its monitor; empty: none is.
  [[nodiscard]] const std::string& beyond_monitor() const { return beyond_monitor_; }

 private:
  void take_value(std::size_t axis, const rsi::ReceivedValue& received, std::optional<double> value);
  void take_stop(const rsi::Sen* answer);
  void apply(std::size_t axis, const rsi::CorrectionRange& range, double monitor);

  rsi::EthernetXml ethernet_;
  rsi::ContextXml context_;
  AxisArray pose_{}, command_{}, values_{};  ///< values in deg and mm
  bool was_clamped_ = false, stop_ = false, stop_rises_ = false;
  std::string beyond_monitor_;
};

}  // namespace vbar::tron::bench
