#pragma once
// Duration of a burn: its delta-v over the acceleration by the thrust, which is constant. (The propellant of a burn of
// 1 m/s is less than a thousandth of the mass.)

#include "fsw/core/gps_time.h"

namespace vbar::fsw::orbit {

/// Accelerations that are accepted, m/s^2: a weaker thrust gives less than a millimetre per second in two hours, a
/// stronger one as much in a microsecond.
inline constexpr double kLeastThrustAcceleration = 1e-7;
inline constexpr double kMostThrustAcceleration = 1e3;

/// Longest burn, s: a larger one counts as this long.
inline constexpr double kLongestBurn_s = 7200.0;

/// Returns the duration of a burn of `dv` (m/s, at least 0) by `acceleration` (m/s^2); 0 without acceleration: an
/// impulse.
constexpr Duration burn_duration(double dv, double acceleration) {
  if (!(acceleration > 0.0)) return {};
  const bool is_longer = dv > kLongestBurn_s * acceleration;
  return nearest_duration(is_longer ? kLongestBurn_s : dv / acceleration);
}

}  // namespace vbar::fsw::orbit
