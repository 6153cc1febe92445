#include "hil_drivers/tron/motion_planning/path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

namespace vbar::tron {

namespace {

struct Durations {
  double ramp_s = 0.0;    ///< ramp of the acceleration from zero to its peak
  double hold_s = 0.0;    ///< at that peak
  double cruise_s = 0.0;  ///< at constant speed
};

Durations durations_of(double distance, const ProgressLimits& limits) {
  if (!(distance > 0.0)) return {};
  const double v = limits.speed, a = limits.acceleration, j = limits.jerk;
  Durations found;
  found.ramp_s = std::min(a / j, std::sqrt(v / j));
  found.hold_s = std::max(0.0, v / (j * found.ramp_s) - found.ramp_s);
  found.cruise_s = distance / v - (2.0 * found.ramp_s + found.hold_s);
  if (found.cruise_s >= 0.0) return found;
  // The speed is not reached.
  found.cruise_s = 0.0;
  found.ramp_s = std::min(a / j, std::cbrt(distance / (2.0 * j)));
  // Distance j ramp (ramp + hold) (2 ramp + hold).
  const double r = found.ramp_s;
  found.hold_s = std::max(0.0, -1.5 * r + std::sqrt(0.25 * r * r + distance / (j * r)));
  return found;
}

Progress advanced(const Progress& from, double jerk, double time_s) {
  const double t = time_s;
  return {from.place + t * (from.speed + t * (0.5 * from.acceleration + t * jerk / 6.0)),
          from.speed + t * (from.acceleration + 0.5 * t * jerk), from.acceleration + t * jerk};
}

}  // namespace

double rest_to_rest_s(double distance, const ProgressLimits& limits) {
  const Durations parts = durations_of(distance, limits);
  return 2.0 * (2.0 * parts.ramp_s + parts.hold_s) + parts.cruise_s;
}

void SCurve::add(double duration_s, double jerk) {
  if (!(duration_s > 0.0)) return;
  phases_[count_++] = {duration_s_, jerk, end_};
  end_ = advanced(end_, jerk, duration_s);
  duration_s_ += duration_s;
}

SCurve SCurve::rest_to_rest(double distance, const ProgressLimits& limits) {
  const Durations parts = durations_of(distance, limits);
  SCurve curve;
  curve.limits_ = limits;
  const double j = limits.jerk;
  curve.add(parts.ramp_s, j);
  curve.add(parts.hold_s, 0.0);
  curve.add(parts.ramp_s, -j);
  curve.add(parts.cruise_s, 0.0);
  curve.add(parts.ramp_s, -j);
  curve.add(parts.hold_s, 0.0);
  curve.add(parts.ramp_s, j);
  curve.end_ = {distance > 0.0 ? distance : 0.0, 0.0, 0.0};
  return curve;
}

Progress SCurve::at(double time_s) const {
  if (count_ == 0 || time_s >= duration_s_) return {end_.place, 0.0, 0.0};
  std::size_t k = count_ - 1;
  while (k > 0 && phases_[k].begin_s > time_s) --k;
  return advanced(phases_[k].start, phases_[k].jerk, std::max(0.0, time_s - phases_[k].begin_s));
}

SCurve SCurve::stop_at(double time_s) const {
  SCurve stop;
  stop.limits_ = limits_;
  stop.end_ = at(time_s);
  if (time_s >= duration_s_ || count_ == 0) return stop;
  const double a = limits_.acceleration, j = limits_.jerk;
  const double speed = std::max(0.0, stop.end_.speed), now = stop.end_.acceleration;
  // Down to -peak, hold, up to zero, with speed zero at the end.
  double peak = std::sqrt(std::max(0.0, j * speed + 0.5 * now * now));
  double hold_s = 0.0;
  if (peak > a) {
    hold_s = (speed + 0.5 * now * now / j - a * a / j) / a;
    peak = a;
  }
  peak = std::max(peak, -now);  // the last ramp of a motion: it is the stop
  stop.add((now + peak) / j, -j);
  stop.add(hold_s, 0.0);
  stop.add(peak / j, j);
  stop.end_.place = std::min(stop.end_.place, end_.place);
  stop.end_.speed = stop.end_.acceleration = 0.0;
  return stop;
}

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

TestbedAxisLimits::TestbedAxisLimits(const TestbedDesign& bench)
    : camera_(scaled(bench.camera_robot.design.axes, bench.motion.override_fraction)),
      target_(scaled(bench.target_robot.design.axes, bench.motion.override_fraction)),
      track_(bench.track.axis) {
  track_.speed *= bench.motion.override_fraction;
  track_.acceleration *= bench.motion.override_fraction;
  track_.jerk *= bench.motion.override_fraction;
}

ProgressLimits TestbedAxisLimits::slower_of(const ProgressLimits& one, const ProgressLimits& other) {
  return {std::min(one.speed, other.speed), std::min(one.acceleration, other.acceleration),
          std::min(one.jerk, other.jerk)};
}

ProgressLimits TestbedAxisLimits::of_camera_arm(const Joints& from, const Joints& to) const {
  return of_arm(camera_, from, to);
}

ProgressLimits TestbedAxisLimits::of_target_arm(const Joints& from, const Joints& to) const {
  return of_arm(target_, from, to);
}

ProgressLimits TestbedAxisLimits::of_carriage(double from_m, double to_m) const {
  ProgressLimits limits = unlimited();
  slow_down(limits, to_m - from_m, track_);
  return limits;
}

ProgressLimits TestbedAxisLimits::of(const Posture& from, const Posture& to) const {
  return slower_of(
      slower_of(of_camera_arm(from.camera_rad, to.camera_rad), of_target_arm(from.target_rad, to.target_rad)),
      of_carriage(from.carriage_m, to.carriage_m));
}

void Path::go_to(const Posture& posture, const TestbedAxisLimits& limits, double cycle_s) {
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

namespace {

/// A posture may be this much beyond a limit by rounding, and the cable turned this much farther by a correction.
constexpr double kLimitRounding = 1e-6;
constexpr double kCableCorrection_rad = 0.035;
/// Share of the clearance that is kept at a corrected posture.
constexpr double kCorrectedClearance = 0.5;

bool is_within(const Arm& arm, const Joints& joints) {
  for (std::size_t k = 0; k < kJoints; ++k) {
    const double angle = joints[static_cast<Eigen::Index>(k)];
    const AxisLimits& axis = arm.design().axes[k];
    if (angle < axis.lower - kLimitRounding || angle > axis.upper + kLimitRounding) return false;
  }
  return true;
}

}  // namespace

PathPlanner::PathPlanner(const TestbedDesign& bench, const TestbedBodies& bodies)
    : bodies_(bodies),
      limits_(bench),
      track_(bench.track.axis),
      camera_home_(Joints::Map(bench.camera_robot.home_rad.data())),
      target_home_(Joints::Map(bench.target_robot.home_rad.data())),
      cable_turn_rad_(bench.motion.cable_turn_rad),
      cycle_s_(bench.motion.cycle_s) {}

std::string PathPlanner::refusal_of(const Posture& posture) const {
  if (!is_finite(posture)) return "is not finite";
  if (!is_within(bodies_.arms().camera_arm(), posture.camera_rad)) return "is beyond a limit of the camera's arm";
  if (!is_within(bodies_.arms().target_arm(), posture.target_rad)) return "is beyond a limit of the target's arm";
  if (posture.carriage_m < track_.lower - kLimitRounding || posture.carriage_m > track_.upper + kLimitRounding)
    return "is beyond the track";
  const double turned = std::abs(posture.camera_rad[3] + posture.camera_rad[5]);
  if (turned > cable_turn_rad_ + kCableCorrection_rad) return "twists the cable of the camera too far";
  return {};
}

double PathPlanner::clearance_for(const Posture& from, const Posture& to) const {
  const double clearance_m = bodies_.clearance_m();
  const bool is_kept = bodies_.is_free(bodies_.at(from)) && bodies_.is_free(bodies_.at(to));
  return is_kept ? clearance_m : kCorrectedClearance * clearance_m;
}

bool PathPlanner::is_straight_free(const Posture& from, const Posture& to) const {
  return bodies_.collision_between(from, to, clearance_for(from, to)).empty();
}

Path PathPlanner::through(const Posture& from, const std::vector<Posture>& postures) const {
  Path path(from);
  for (const Posture& posture : postures) path.go_to(posture, limits_, cycle_s_);
  return path;
}

std::variant<Path, PathFailure> PathPlanner::plan(const Posture& from, const Posture& to) const {
  // Where the arms stand is a fact, also if it is a little beyond a limit.
  if (!is_finite(from)) return PathFailure{"the posture at the start of a path is not finite"};
  if (const std::string refusal = refusal_of(to); !refusal.empty())
    return PathFailure{fmt::format("the posture at the end of a path {}", refusal)};
  const double clearance_m = clearance_for(from, to);
  for (const auto& [posture, name] : {std::pair(&from, "start"), std::pair(&to, "end")})
    if (const std::string found = bodies_.collision(bodies_.at(*posture), clearance_m); !found.empty())
      return PathFailure{
          fmt::format("at the {} of a path {} are closer than {:.0f} mm", name, found, 1e3 * clearance_m)};
  const std::string blocked = bodies_.collision_between(from, to, clearance_m);
  // |A4 + A6| is at most the larger of its ends on a straight line, so the cable needs no samples.
  if (blocked.empty()) return through(from, {to});

  const std::vector<std::vector<Posture>> detours{
      {{from.camera_rad, target_home_, from.carriage_m}, {to.camera_rad, target_home_, to.carriage_m}, to},
      {{camera_home_, from.target_rad, from.carriage_m}, {camera_home_, to.target_rad, to.carriage_m}, to},
      {{camera_home_, target_home_, from.carriage_m}, {camera_home_, target_home_, to.carriage_m}, to},
      // One arm after the other.
      {{camera_home_, from.target_rad, from.carriage_m},
       {camera_home_, target_home_, to.carriage_m},
       {camera_home_, to.target_rad, to.carriage_m},
       to},
      {{from.camera_rad, target_home_, from.carriage_m},
       {camera_home_, target_home_, to.carriage_m},
       {to.camera_rad, target_home_, to.carriage_m},
       to},
  };
  std::variant<Path, PathFailure> best = PathFailure{
      fmt::format("the path is blocked: {} would be closer than the clearance, also over retracted postures", blocked)};
  for (const auto& detour : detours) {
    Path path = through(from, detour);
    if (const Path* found = std::get_if<Path>(&best); found != nullptr && found->cycles() <= path.cycles()) continue;
    bool is_free = true;
    const Posture* last = &from;
    for (const Posture& posture : detour) {
      is_free = is_free && bodies_.collision_between(*last, posture, clearance_m).empty();
      last = &posture;
    }
    if (is_free) best = std::move(path);
  }
  return best;
}

}  // namespace vbar::tron
