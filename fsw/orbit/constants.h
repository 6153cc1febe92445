#pragma once
// Earth constants of the flight software's orbit models: those of GGM05S, with its C20 as J2.

namespace vbar::fsw::orbit {

inline constexpr double kMu = 3.986004415e14;      ///< m^3/s^2
inline constexpr double kEarthRadius = 6378136.3;  ///< m, equatorial, reference of the gravity model
inline constexpr double kJ2 = 1.0826358191967e-3;  ///< -sqrt(5) C20

}  // namespace vbar::fsw::orbit
