#include "emulators/tron/controller/axis_servo.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

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

namespace {

/// Commands arrive with four decimals: half a unit of the last one, in rad or m.
double resolution(std::size_t axis) {
  return axis == kTrackAxis ? 0.5e-4 / rsi::kMillimetresPerMetre : 0.5e-4 / rsi::kDegreesPerRadian;
}

double wire_units(std::size_t axis) {
  return axis == kTrackAxis ? rsi::kMillimetresPerMetre : rsi::kDegreesPerRadian;
}

std::string name_of(std::size_t axis) {
  return axis == kTrackAxis ? "E1" : fmt::format("A{}", axis + 1);
}

}  // namespace

void AxisMonitor::begin(const AxisArray& start) {
  last_ = start;
  speed_ = {};
  has_speed_ = true;
}

std::string AxisMonitor::judge_axis(std::size_t axis, double command, int cycles) {
  const AxisLimits& limits = limits_[axis];
  const double rounding = resolution(axis);
  const double scale = wire_units(axis);
  if (!(command >= limits.lower - rounding && command <= limits.upper + rounding))
    return fmt::format("software limit of {}: {:.4f}", name_of(axis), command * scale);
  const double step = std::abs(command - last_[axis]);
  const double time = std::min(cycles, 3) * cycle_s_;
  max_speed_[axis] = std::max(max_speed_[axis], step / time);
  if (!(step <= limits.speed * time + 2.0 * rounding))
    return fmt::format("speed of {} above its limit: {:.4f} of {:.4f} a second", name_of(axis), step / time * scale,
                       limits.speed * scale);
  if (cycles > 1 || !has_speed_) return {};
  const double acceleration = std::abs((command - last_[axis]) / cycle_s_ - speed_[axis]) / cycle_s_;
  max_acceleration_[axis] = std::max(max_acceleration_[axis], acceleration);
  if (!(acceleration <= limits.acceleration + 4.0 * rounding / (cycle_s_ * cycle_s_)))
    return fmt::format("acceleration of {} above its limit: {:.4f} of {:.4f} a second squared", name_of(axis),
                       acceleration * scale, limits.acceleration * scale);
  return {};
}

std::string AxisMonitor::judge(const AxisArray& command, int cycles) {
  std::string problem;
  for (std::size_t axis = 0; axis < kServoAxes; ++axis) {
    const std::string found = judge_axis(axis, command[axis], cycles);
    if (problem.empty()) problem = found;
    speed_[axis] = (command[axis] - last_[axis]) / cycle_s_;
  }
  has_speed_ = cycles == 1;
  last_ = command;
  return problem;
}

Correction::Correction(const rsi::EthernetXml& ethernet, const rsi::ContextXml& context)
    : ethernet_(ethernet), context_(context) {}

void Correction::begin(const AxisArray& pose) {
  pose_ = command_ = pose;
  values_ = {};
  was_clamped_ = stop_ = stop_rises_ = false;
  beyond_monitor_.clear();
}

void Correction::take_value(std::size_t axis, const rsi::ReceivedValue& received, std::optional<double> value) {
  if (value)
    values_[axis] = *value;
  else if (!received.holds_on)
    values_[axis] = 0.0;
}

void Correction::take_stop(const rsi::Sen* answer) {
  const bool before = stop_;
  if (answer != nullptr && answer->stop)
    stop_ = *answer->stop;
  else if (!ethernet_.stop.holds_on)
    stop_ = false;
  stop_rises_ = stop_ && !before;
}

void Correction::apply(std::size_t axis, const rsi::CorrectionRange& range, double monitor) {
  const double value = std::clamp(values_[axis], range.lower, range.upper);
  was_clamped_ = was_clamped_ || value != values_[axis];
  if (!(std::abs(value) <= monitor) && beyond_monitor_.empty())
    beyond_monitor_ =
        fmt::format("{}: {:.4f} of {:.4f}", axis == kTrackAxis ? "E1" : fmt::format("A{}", axis + 1), value, monitor);
  command_[axis] = pose_[axis] + value / (axis == kTrackAxis ? rsi::kMillimetresPerMetre : rsi::kDegreesPerRadian);
}

void Correction::take(const rsi::Sen* answer) {
  was_clamped_ = false;
  take_stop(answer);
  for (std::size_t k = 0; k < rsi::kWireAxes; ++k) {
    take_value(k, ethernet_.axes[k], answer == nullptr ? std::nullopt : answer->axes_deg[k]);
    apply(k, context_.axes[k], context_.monitor_deg[k]);
  }
  if (!context_.track) return;
  take_value(kTrackAxis, ethernet_.track, answer == nullptr ? std::nullopt : answer->track_mm);
  apply(kTrackAxis, *context_.track, context_.track_monitor_mm);
}

}  // namespace vbar::tron::bench
