#pragma once
// A gravity field of degrees 2 to 4 whose coefficients change from call to call, as those of the tides do: small enough
// to be summed term by term, where GravityField prepares its series once.

#include "fsw/core/types.h"

namespace vbar::truth {

/// Fully normalised coefficients, as in gravity_coefficients.h: c[n][m], s[n][m], 0 <= m <= n <= 4. Degrees 0 and 1 are
/// not used.
struct LowDegreeCoefficients {
  static constexpr int kDegree = 4;
  double c[kDegree + 1][kDegree + 1] = {};
  double s[kDegree + 1][kDegree + 1] = {};
};

/// Returns the acceleration, m/s^2 in ITRF, at a position (m, in ITRF, not the centre) in the field of `coefficients`
/// with gravitational parameter `gm` (m^3/s^2) and reference radius `radius` (m).
fsw::Vector3 acceleration_itrf(const LowDegreeCoefficients& coefficients, double gm, double radius,
                               const fsw::Vector3& position_itrf);

}  // namespace vbar::truth
