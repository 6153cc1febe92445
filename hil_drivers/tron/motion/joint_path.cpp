#include "hil_drivers/tron/motion/joint_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace vbar::tron {
namespace {

/// Shorter ways, rad or m, are no motion: a thousandth of the encoders' resolution on the wire.
constexpr double kNoWay = 1e-9;

/// Of the path parameter over a way; nothing if nothing moves.
std::optional<RateLimits> rate_limits(const std::vector<AxisLimits>& limits, const AxisValues& way) {
  constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  RateLimits rates{kUnlimited, kUnlimited, kUnlimited};
  for (int k = 0; k < kAxes; ++k) {
    const double length = std::abs(way(k));
    if (length < kNoWay) continue;
    const AxisLimits& axis = limits[static_cast<std::size_t>(k)];
    rates.speed = std::min(rates.speed, axis.speed / length);
    rates.acceleration = std::min(rates.acceleration, axis.acceleration / length);
    rates.jerk = std::min(rates.jerk, axis.jerk / length);
  }
  if (rates.speed == kUnlimited) return std::nullopt;
  return rates;
}

}  // namespace

AxisValues axis_values(const Posture& posture) {
  AxisValues values;
  values << posture.camera_rad, posture.target_rad, posture.carriage_m;
  return values;
}

Posture posture_of(const AxisValues& values) {
  return {values.head<6>(), values.segment<6>(6), values(12)};
}

std::vector<AxisLimits> motion_limits(const BenchFile& bench) {
  std::vector<AxisLimits> limits(bench.camera_robot.design.axes.begin(), bench.camera_robot.design.axes.end());
  limits.insert(limits.end(), bench.target_robot.design.axes.begin(), bench.target_robot.design.axes.end());
  limits.push_back(bench.track.axis);
  for (AxisLimits& axis : limits) {
    axis.speed *= bench.motion.override_fraction;
    axis.acceleration *= bench.motion.override_fraction;
    axis.jerk *= bench.motion.override_fraction;
  }
  return limits;
}

double move_time_s(const std::vector<AxisLimits>& limits, const Posture& from, const Posture& to) {
  const auto rates = rate_limits(limits, axis_values(to) - axis_values(from));
  return rates ? SCurve(*rates).duration_s() : 0.0;
}

JointPath::JointPath(const BenchFile& bench, const std::vector<Posture>& postures)
    : limits_(motion_limits(bench)), cycle_s_(bench.motion.cycle_s), start_(axis_values(postures.front())) {
  for (std::size_t k = 1; k < postures.size(); ++k) {
    const AxisValues from = axis_values(postures[k - 1]);
    const AxisValues way = axis_values(postures[k]) - from;
    const auto rates = rate_limits(limits_, way);
    if (!rates) continue;
    const SCurve curve(*rates);
    const int cycles = static_cast<int>(std::ceil(curve.duration_s() / cycle_s_));
    lines_.push_back({from, way, curve, cycles_, cycles, curve.duration_s() / (cycles * cycle_s_)});
    cycles_ += cycles;
  }
}

const JointPath::Line& JointPath::line_at(double cycle) const {
  const auto after = std::ranges::find_if(lines_, [cycle](const Line& line) { return line.first_cycle > cycle; });
  return after == lines_.begin() ? lines_.front() : *std::prev(after);
}

Posture JointPath::at(double cycle) const {
  if (lines_.empty()) return posture_of(start_);
  const Line& line = line_at(cycle);
  const double position = line.curve.at((cycle - line.first_cycle) * cycle_s_ * line.stretch).position;
  return posture_of(line.from + position * line.way);
}

Posture JointPath::at(int cycle) const {
  return at(static_cast<double>(cycle));
}

std::vector<Posture> JointPath::stop_after(int cycle) const {
  std::vector<Posture> postures;
  if (lines_.empty() || cycle <= 0 || cycle >= cycles_) return postures;
  const Line& line = line_at(cycle);
  const auto state = line.curve.at((cycle - line.first_cycle) * cycle_s_ * line.stretch);
  // Path time goes on at a rate that falls from 1 to 0 as a cubic does, whose slope is 1.5 over the duration at most.
  // What it adds to the acceleration of an axis is its speed times that slope: as much as the motion itself may have.
  double duration_s = 10.0 * cycle_s_;
  for (int k = 0; k < kAxes; ++k) {
    const double speed = std::abs(line.way(k)) * state.speed;
    duration_s = std::max(duration_s, 1.5 * speed / limits_[static_cast<std::size_t>(k)].acceleration);
  }
  const int count = static_cast<int>(std::ceil(duration_s / cycle_s_));
  for (int k = 1; k <= count; ++k) {
    const double u = static_cast<double>(k) / count;
    // The integral of the rate 1 - 3 u^2 + 2 u^3.
    const double path_cycles = count * (u - u * u * u + 0.5 * u * u * u * u);
    postures.push_back(at(std::min(cycle + path_cycles, static_cast<double>(line.first_cycle + line.cycles))));
  }
  return postures;
}

}  // namespace vbar::tron
