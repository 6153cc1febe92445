#include "hil_drivers/tron/motion/path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace vbar::tron {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Less than this share of a cycle is rounding.
constexpr double kCycleRounding = 1e-9;

std::array<AxisLimits, kJoints> scaled(std::array<AxisLimits, kJoints> axes, double factor) {
  for (AxisLimits& axis : axes) {
    axis.speed *= factor;
    axis.acceleration *= factor;
    axis.jerk *= factor;
  }
  return axes;
}

void slow_down(ProgressLimits& limits, double distance, const AxisLimits& axis) {
  if (distance == 0.0) return;
  const double length = std::abs(distance);
  limits.speed = std::min(limits.speed, axis.speed / length);
  limits.acceleration = std::min(limits.acceleration, axis.acceleration / length);
  limits.jerk = std::min(limits.jerk, axis.jerk / length);
}

ProgressLimits unlimited() {
  return {kInfinity, kInfinity, kInfinity};
}

ProgressLimits of_arm(const std::array<AxisLimits, kJoints>& axes, const Joints& from, const Joints& to) {
  ProgressLimits limits = unlimited();
  for (std::size_t k = 0; k < kJoints; ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    slow_down(limits, to[at] - from[at], axes[k]);
  }
  return limits;
}

}  // namespace

Posture between(const Posture& from, const Posture& to, double share) {
  if (share <= 0.0) return from;
  if (share >= 1.0) return to;
  return {from.camera_rad + share * (to.camera_rad - from.camera_rad),
          from.target_rad + share * (to.target_rad - from.target_rad),
          from.carriage_m + share * (to.carriage_m - from.carriage_m)};
}

AxisLimitsOfBench::AxisLimitsOfBench(const BenchFile& bench)
    : camera_(scaled(bench.camera_robot.design.axes, bench.motion.override_fraction)),
      target_(scaled(bench.target_robot.design.axes, bench.motion.override_fraction)),
      track_(bench.track.axis) {
  track_.speed *= bench.motion.override_fraction;
  track_.acceleration *= bench.motion.override_fraction;
  track_.jerk *= bench.motion.override_fraction;
}

ProgressLimits AxisLimitsOfBench::slower_of(const ProgressLimits& one, const ProgressLimits& other) {
  return {std::min(one.speed, other.speed), std::min(one.acceleration, other.acceleration),
          std::min(one.jerk, other.jerk)};
}

ProgressLimits AxisLimitsOfBench::of_camera_arm(const Joints& from, const Joints& to) const {
  return of_arm(camera_, from, to);
}

ProgressLimits AxisLimitsOfBench::of_target_arm(const Joints& from, const Joints& to) const {
  return of_arm(target_, from, to);
}

ProgressLimits AxisLimitsOfBench::of_carriage(double from_m, double to_m) const {
  ProgressLimits limits = unlimited();
  slow_down(limits, to_m - from_m, track_);
  return limits;
}

ProgressLimits AxisLimitsOfBench::of(const Posture& from, const Posture& to) const {
  return slower_of(
      slower_of(of_camera_arm(from.camera_rad, to.camera_rad), of_target_arm(from.target_rad, to.target_rad)),
      of_carriage(from.carriage_m, to.carriage_m));
}

void Path::go_to(const Posture& posture, const AxisLimitsOfBench& limits, double cycle_s) {
  if (!is_finite(posture) || !is_finite(end_)) throw std::invalid_argument("a posture of a path is not finite");
  const ProgressLimits progress = limits.of(end_, posture);
  if (std::isfinite(progress.speed)) {
    Leg leg{end_, posture, SCurve::rest_to_rest(1.0, progress), cycles(), 0, cycle_s};
    leg.cycles = std::max(1, static_cast<int>(std::ceil(leg.curve.duration_s() / cycle_s - kCycleRounding)));
    legs_.push_back(leg);
  }
  end_ = posture;
}

int Path::cycles() const {
  return legs_.empty() ? 0 : legs_.back().first + legs_.back().cycles;
}

Posture Path::on(const Leg& leg, int cycle) {
  const double time_s = cycle >= leg.cycles ? leg.curve.duration_s() : cycle * leg.cycle_s;
  return between(leg.from, leg.to, leg.curve.at(time_s).place);
}

Posture Path::at(int cycle) const {
  if (cycle <= 0 || legs_.empty()) return start_;
  if (cycle >= cycles()) return end_;
  const auto after = std::ranges::upper_bound(legs_, cycle, {}, &Leg::first);
  const Leg& leg = *std::prev(after);
  return on(leg, cycle - leg.first);
}

Path Path::stop_after(int cycle) const {
  Path stop(at(cycle));
  if (cycle <= 0 || cycle >= cycles()) return stop;
  Leg leg = *std::prev(std::ranges::upper_bound(legs_, cycle, {}, &Leg::first));
  leg.curve = leg.curve.stop_at((cycle - leg.first) * leg.cycle_s);
  leg.first = 0;
  leg.cycles = static_cast<int>(std::ceil(leg.curve.duration_s() / leg.cycle_s - kCycleRounding));
  if (leg.cycles <= 0) return stop;
  stop.end_ = on(leg, leg.cycles);
  stop.legs_.push_back(leg);
  return stop;
}

}  // namespace vbar::tron
