#include "hil_drivers/tron/bench/controller/axis_monitor.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace vbar::tron::bench {
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

}  // namespace vbar::tron::bench
