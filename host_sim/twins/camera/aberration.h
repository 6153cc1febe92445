#pragma once
// Apparent direction, for a moving observer, of light that comes from `direction`.

#include <cmath>

#include "fsw/core/types.h"

namespace vbar::twins::camera {

inline constexpr double kLightSpeed = 299792458.0;  ///< m/s

/// Returns the apparent direction as a unit vector; `direction` unit, `velocity` of the observer in the same axes, m/s,
/// below that of light. Special relativity (Klioner 2003, equation 10); the Sun's field would add 0.4 milliarcsecond.
inline fsw::Vector3 apparent_direction(const fsw::Vector3& direction, const fsw::Vector3& velocity) {
  const fsw::Vector3 beta = velocity / kLightSpeed;
  const double inverse_gamma = std::sqrt(1.0 - beta.squaredNorm());
  const double along = direction.dot(beta);
  const fsw::Vector3 seen = inverse_gamma * direction + (1.0 + along / (1.0 + inverse_gamma)) * beta;
  return seen.normalized();
}

}  // namespace vbar::twins::camera
