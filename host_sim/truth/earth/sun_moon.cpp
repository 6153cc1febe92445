#include "host_sim/truth/earth/sun_moon.h"

#include <cmath>

#include <erfa.h>

namespace vbar::truth {

namespace {

constexpr double kJ2000 = 2451545.0;
// Six hours apart: the shortest relevant lunar terms (some days) leave decimetres, and a day of flight needs ten nodes.
constexpr double kNodesPerDay = 4.0;

}  // namespace

SunMoon sun_moon_series(JulianDate tt) {
  double heliocentric[2][3], barycentric[2][3], moon[2][3];
  // Its status only warns of a date outside 1900 to 2100, where the series degrade slowly.
  static_cast<void>(eraEpv00(tt.day, tt.fraction, heliocentric, barycentric));
  eraMoon98(tt.day, tt.fraction, moon);
  SunMoon positions;
  for (int axis = 0; axis < 3; ++axis) {
    positions.sun_eci[axis] = -kAstronomicalUnit * heliocentric[0][axis];
    positions.moon_eci[axis] = kAstronomicalUnit * moon[0][axis];
  }
  return positions;
}

SunMoon SunMoonInterpolator::at(JulianDate tt) {
  const double position = ((tt.day - kJ2000) + tt.fraction) * kNodesPerDay;
  const double floor = std::floor(position);
  const auto interval = static_cast<std::int64_t>(floor);
  if (!ready_ || interval != interval_) enter_interval(interval);
  const double t = position - floor;
  return {{node_polynomial(sun_[0], t), node_polynomial(sun_[1], t), node_polynomial(sun_[2], t)},
          {node_polynomial(moon_[0], t), node_polynomial(moon_[1], t), node_polynomial(moon_[2], t)}};
}

void SunMoonInterpolator::enter_interval(std::int64_t interval) {
  double sun[3][kNodePoints], moon[3][kNodePoints];
  for (int i = 0; i < kNodePoints; ++i) {
    const SunMoon& positions = node(interval + kFirstNode + i);
    for (int axis = 0; axis < 3; ++axis) {
      sun[axis][i] = positions.sun_eci[axis];
      moon[axis][i] = positions.moon_eci[axis];
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    fit_node_polynomial(sun[axis], sun_[axis]);
    fit_node_polynomial(moon[axis], moon_[axis]);
  }
  interval_ = interval;
  ready_ = true;
}

const SunMoon& SunMoonInterpolator::node(std::int64_t index) {
  const auto found = nodes_.find(index);
  if (found != nodes_.end()) return found->second;
  return nodes_.emplace(index, sun_moon_series({kJ2000, static_cast<double>(index) / kNodesPerDay})).first->second;
}

fsw::Vector3 earth_velocity_bcrs(JulianDate tt) {
  double heliocentric[2][3], barycentric[2][3];
  static_cast<void>(eraEpv00(tt.day, tt.fraction, heliocentric, barycentric));  // warns of dates outside 1900 to 2100
  const double scale = kAstronomicalUnit / kSecondsPerDay;
  return {scale * barycentric[1][0], scale * barycentric[1][1], scale * barycentric[1][2]};
}

}  // namespace vbar::truth
