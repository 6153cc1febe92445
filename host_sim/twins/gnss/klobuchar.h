#pragma once
// The broadcast ionosphere of GPS (Klobuchar 1987; IS-GPS-200N 20.3.3.5.2.5) and its part above a low orbit.

#include <array>

#include "fsw/core/types.h"

namespace vbar::twins::gnss {

struct KlobucharCoefficients {
  std::array<double, 4> alpha{};  ///< s, s/semicircle, ...
  std::array<double, 4> beta{};
  friend bool operator==(const KlobucharCoefficients&, const KlobucharCoefficients&) = default;
};

/// Returns the delay of an L1 signal on the ground, m. Latitude, longitude (geodetic), elevation, azimuth in rad; time
/// of GPS week.
double klobuchar_delay_m(const KlobucharCoefficients& coefficients, double latitude, double longitude, double elevation,
                         double azimuth, double seconds_of_week);

/// Returns the vertical delay at a point of the ionosphere (latitude, longitude of the piercing point), m.
double klobuchar_vertical_delay_m(const KlobucharCoefficients& coefficients, double latitude, double longitude,
                                  double seconds_of_week);

/// Returns the share of the electron content that lies above `altitude_m` (1 at the ground): a Chapman-like profile
/// with its peak at 420 km and a scale height of 100 km (Montenbruck, Gill 2002: "Ionospheric correction for GPS
/// tracking of LEO satellites"). Altitudes below the ground count as the ground.
double electron_content_above(double altitude_m);

/// Returns the altitude of the thin shell that represents the electrons above `altitude_m`: half of them lie below it,
/// m (the same source).
double shell_altitude_m(double altitude_m);

/// Returns the delay of an L1 signal at a point in or above the ionosphere, m: the model's vertical delay where the
/// line of sight pierces that shell, the share above the point, slant by the shell's geometry, which holds for
/// elevations below the horizontal too. Both vectors in ECEF; `line_of_sight` is the unit vector to the satellite.
double klobuchar_delay_in_orbit_m(const KlobucharCoefficients& coefficients, const fsw::Vector3& position_ecef,
                                  const fsw::Vector3& line_of_sight, double seconds_of_week);

}  // namespace vbar::twins::gnss
