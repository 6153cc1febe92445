#include "fsw/orbit/sun.h"
#include "fsw/math/math.h"
namespace vbar::fsw::orbit {
namespace {
Vector3 sun_position(double t) {
  const double deg = 0.017453292519943295;
  const double m = (357.5256 + 35999.049 * t) * deg;
  const double l = (282.94 + 0.3226 * t) * deg + m + (6892.0 * math::sin(m) + 72.0 * math::sin(2 * m)) / 3600.0 * deg;
  const double r = (149.619 - 2.499 * math::cos(m) - 0.021 * math::cos(2 * m)) * 1e9;
  const double e = 23.43929111 * deg;
  return {r * math::cos(l), r * math::sin(l) * math::cos(e), r * math::sin(l) * math::sin(e)};
}
double centuries(GpsTime time) { return (static_cast<double>(time.ns) * 1e-9 + 51.184 - 630763200.0 - 0.0) / (86400.0 * 36525.0); }
}
Vector3 sun_direction_eci(GpsTime time) { return sun_position(centuries(time)).normalized(); }
Vector3 earth_velocity_eci(GpsTime time) {
  const double t = centuries(time);
  const double h = 3600.0 / (86400.0 * 36525.0);
  return -(sun_position(t + h) - sun_position(t - h)) / 7200.0;
}
}
