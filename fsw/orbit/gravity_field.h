#pragma once
// The Earth's gravity in flight software: the constants of its orbit models, and the acceleration where J2 is not
// sufficient, of degree and order 20. The harmonics of higher degree change the acceleration within five minutes of a
// low orbit and cause half a metre of relative error in six hours at 75 km separation.

#include "fsw/core/types.h"

namespace vbar::fsw::orbit {

// Constants of GGM05S, with its C20 as J2.
inline constexpr double kMu = 3.986004415e14;      ///< m^3/s^2
inline constexpr double kEarthRadius = 6378136.3;  ///< m, equatorial, reference of the gravity model
inline constexpr double kJ2 = 1.0826358191967e-3;  ///< -sqrt(5) C20

/// Returns the gravitational acceleration, m/s^2 in ITRF, point mass included, at a position (m, ITRF) outside the
/// Earth; the centre is not allowed. Method: each component of the gradient is a harmonic series of one degree more
/// (Cunningham 1970); Legendre functions are divided by cos^m(latitude), so that the poles are not singular (Pines
/// 1973). About 4,000 operations.
Vector3 gravity_itrf(const Vector3& position_itrf);

}  // namespace vbar::fsw::orbit
