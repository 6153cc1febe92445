#pragma once
// The single-frequency ionospheric model that GPS broadcasts (Klobuchar 1987; IS-GPS-200N, 20.3.3.5.2.5).

#include <array>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/core/types.h"

namespace vbar::fsw::gnss {

/// Coefficients as broadcast: alpha and beta in s, s/semicircle, ...
struct KlobucharCoefficients {
  std::array<double, 4> alpha{};
  std::array<double, 4> beta{};
};

/// Returns kOk if the coefficients are within the range of the message's fields (IS-GPS-200N, table 20-X).
Status check(const KlobucharCoefficients& coefficients);

/// Direction of the signal as seen by a user; rad.
struct LineOfSight {
  double latitude = 0.0;   ///< latitude of the user, geodetic
  double longitude = 0.0;  ///< longitude of the user
  double azimuth = 0.0;    ///< azimuth of the satellite, from north over east
  double elevation = 0.0;  ///< elevation of the satellite
};

/// Returns the group delay at L1, m, for a user at the ground: the complete ionosphere. It is proportional to the
/// inverse square of the frequency; the phase advance is the same. kNotFinite; kOutOfRange for an elevation outside [0,
/// pi/2], where the model's mapping is not valid (it has a pole at -19.8 degrees), or coefficients that fail check().
Result<double> klobuchar_delay_l1_m(const KlobucharCoefficients& coefficients, const LineOfSight& sight, GpsTime time);

/// Point where a signal passes the electrons above a spacecraft in a low orbit.
struct ShellCrossing {
  double slant_factor = 1.0;  ///< delay over that of a vertical signal at the same place
  double distance_m = 0.0;    ///< from the spacecraft along the line of sight
};

/// Returns the crossing of a thin shell with half of the electrons above the spacecraft below it (Montenbruck, Gill
/// 2002: "Ionospheric correction for GPS tracking of LEO satellites"; peak of the density at 420 km, scale height 100
/// km), also for elevations below the horizon. `position_m` is from the Earth's centre, `direction` the unit vector to
/// the satellite, in any frame. The default value is returned for a position at or below the ground.
ShellCrossing shell_crossing(const Vector3& position_m, const Vector3& direction);

}  // namespace vbar::fsw::gnss
