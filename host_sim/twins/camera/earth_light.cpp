#include "host_sim/twins/camera/earth_light.h"

#include <algorithm>
#include <cmath>

namespace vbar::twins::camera {

double earth_light_factor(double cosine, double sine_earth) {
  if (cosine >= sine_earth) return cosine;
  if (cosine <= -sine_earth) return 0.0;
  const double sin2 = sine_earth * sine_earth, sine = std::sqrt(1.0 - cosine * cosine);
  const double x = std::sqrt(std::max(0.0, 1.0 / sin2 - 1.0)), y = std::clamp(-x * cosine / sine, -1.0, 1.0);
  const double s = sine * std::sqrt(1.0 - y * y);
  return std::max(0.0, ((cosine * std::acos(y) - x * s) * sin2 + std::atan2(s, x)) / (M_PI * sin2));
}

}  // namespace vbar::twins::camera
