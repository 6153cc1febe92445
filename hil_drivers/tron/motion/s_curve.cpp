#include "hil_drivers/tron/motion/s_curve.h"

#include <algorithm>
#include <cmath>

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

}  // namespace vbar::tron
