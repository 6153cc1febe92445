#include "hil_drivers/tron/motion/s_curve.h"

#include <cmath>

namespace vbar::tron {

SCurve::SCurve(const RateLimits& limits) : jerk_(limits.jerk) {
  const double v = limits.speed, a = limits.acceleration, j = limits.jerk;
  // As if speed were reached; then without a cruise; then without constant acceleration either.
  if (v * j < a * a) {
    jerk_s_ = std::sqrt(v / j);
    ramp_s_ = 2.0 * jerk_s_;
  } else {
    jerk_s_ = a / j;
    ramp_s_ = jerk_s_ + v / a;
  }
  cruise_s_ = 1.0 / v - ramp_s_;
  if (cruise_s_ < 0.0) {
    cruise_s_ = 0.0;
    jerk_s_ = a / j;
    ramp_s_ = 0.5 * (jerk_s_ + std::sqrt(jerk_s_ * jerk_s_ + 4.0 / a));
    if (ramp_s_ < 2.0 * jerk_s_) {
      jerk_s_ = std::cbrt(0.5 / j);
      ramp_s_ = 2.0 * jerk_s_;
    }
  }
  acceleration_ = j * jerk_s_;
  speed_ = acceleration_ * (ramp_s_ - jerk_s_);
}

SCurve::State SCurve::ramp_up(double t) const {
  const double a = acceleration_, j = jerk_;
  if (t < jerk_s_) return {j * t * t * t / 6.0, 0.5 * j * t * t, j * t};
  const double s1 = j * jerk_s_ * jerk_s_ * jerk_s_ / 6.0, v1 = 0.5 * a * jerk_s_;
  if (t < ramp_s_ - jerk_s_) {
    const double u = t - jerk_s_;
    return {s1 + v1 * u + 0.5 * a * u * u, v1 + a * u, a};
  }
  // Backwards from the speed reached: the ramp covers half of speed times duration.
  const double u = ramp_s_ - t;
  return {0.5 * speed_ * ramp_s_ - speed_ * u + j * u * u * u / 6.0, speed_ - 0.5 * j * u * u, j * u};
}

SCurve::State SCurve::at(double time_s) const {
  if (!(time_s > 0.0)) return {};
  if (time_s >= duration_s()) return {1.0, 0.0, 0.0};
  if (time_s < ramp_s_) return ramp_up(time_s);
  if (time_s <= ramp_s_ + cruise_s_) return {0.5 * speed_ * ramp_s_ + speed_ * (time_s - ramp_s_), speed_, 0.0};
  const State mirrored = ramp_up(duration_s() - time_s);
  return {1.0 - mirrored.position, mirrored.speed, -mirrored.acceleration};
}

}  // namespace vbar::tron
