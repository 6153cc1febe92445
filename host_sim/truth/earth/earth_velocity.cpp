#include "host_sim/truth/earth/earth_velocity.h"

#include <erfa.h>

#include "host_sim/truth/earth/sun_moon.h"

namespace vbar::truth {

fsw::Vector3 earth_velocity_bcrs(JulianDate tt) {
  double heliocentric[2][3], barycentric[2][3];
  static_cast<void>(eraEpv00(tt.day, tt.fraction, heliocentric, barycentric));  // warns of dates outside 1900 to 2100
  const double scale = kAstronomicalUnit / kSecondsPerDay;
  return {scale * barycentric[1][0], scale * barycentric[1][1], scale * barycentric[1][2]};
}

}  // namespace vbar::truth
