#include "hil_drivers/tron/bench/controller/servo.h"

#include <algorithm>
#include <cmath>

namespace vbar::tron::bench {
namespace {

/// A critically damped system of this natural frequency follows a ramp 2 / frequency behind.
constexpr double kFrequency = 2.0 / Servo::kLag_s;
constexpr double kStandstill = 1e-7;

struct Motion {
  double position, velocity;
};

/// Exact solution over `time`, in which the command moves linearly from `from` to `to`.
Motion advance(const Motion& start, double from, double to, double time) {
  const double slope = (to - from) / time;
  const double lag = 2.0 * slope / kFrequency;
  // Deviation from the steady response to the ramp, and its derivative.
  const double deviation = start.position - (from - lag);
  const double rate = start.velocity - slope + kFrequency * deviation;
  const double decay = std::exp(-kFrequency * time);
  return {to - lag + (deviation + rate * time) * decay,
          slope + (rate - kFrequency * (deviation + rate * time)) * decay};
}

}  // namespace

AxisArray to_array(const AxisPositions& positions) {
  AxisArray values{};
  for (std::size_t k = 0; k < kTrackAxis; ++k) values[k] = positions.axes_rad[static_cast<int>(k)];
  values[kTrackAxis] = positions.track_m;
  return values;
}

AxisPositions to_positions(const AxisArray& values) {
  AxisPositions positions;
  for (std::size_t k = 0; k < kTrackAxis; ++k) positions.axes_rad[static_cast<int>(k)] = values[k];
  positions.track_m = values[kTrackAxis];
  return positions;
}

Servo::Servo(const AxisArray& start, const AxisArray& deceleration, double cycle_s)
    : position_(start), command_(start), deceleration_(deceleration), cycle_s_(cycle_s) {}

void Servo::step(const AxisArray& command) {
  for (std::size_t k = 0; k < kServoAxes; ++k) {
    const Motion next = advance({position_[k], velocity_[k]}, command_[k], command[k], cycle_s_);
    position_[k] = next.position;
    velocity_[k] = next.velocity;
    command_velocity_[k] = (command[k] - command_[k]) / cycle_s_;
  }
  command_ = command;
}

void Servo::follow(const AxisArray& command) {
  step(command);
}

void Servo::brake() {
  AxisArray command = command_;
  for (std::size_t k = 0; k < kServoAxes; ++k) {
    const double speed = std::max(0.0, std::abs(command_velocity_[k]) - deceleration_[k] * cycle_s_);
    command[k] += std::copysign(speed, command_velocity_[k]) * cycle_s_;
  }
  step(command);
}

bool Servo::stands() const {
  for (std::size_t k = 0; k < kServoAxes; ++k)
    if (command_velocity_[k] != 0.0 || std::abs(position_[k] - command_[k]) > kStandstill) return false;
  return true;
}

}  // namespace vbar::tron::bench
