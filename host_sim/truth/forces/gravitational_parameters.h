#pragma once
// Gravitational parameters of the bodies that act on the Earth and its satellites, m^3/s^2, and the speed of light.

namespace vbar::truth {

inline constexpr double kSunGm = 1.32712440041e20;         ///< IERS Conventions 2010, table 1.1, in the time scale TDB
inline constexpr double kMoonPerEarthMass = 0.0123000371;  ///< IERS Conventions 2010, table 1.1
inline constexpr double kSpeedOfLight = 299792458.0;       ///< m/s, exact

}  // namespace vbar::truth
