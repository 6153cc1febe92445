#pragma once
// Orientation of the Earth-fixed frame for on-board use: IERS Conventions 2010, chapter 5 (CIO-based),
//
//   R_itrf_gcrf = W(x_p, y_p) R3(ERA - s) Q(X, Y),
//
// truncated to precession in full and the nineteen largest terms of nutation in X and Y, with s = -X Y / 2. UT1 and
// polar motion, which are measured on the ground, come by telecommand.

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"

namespace vbar::fsw::orbit {

/// Earth orientation as telecommanded: linear in time about an epoch, valid for some days.
struct EarthOrientation {
  GpsTime epoch;
  double ut1_minus_gps_s = -15.0;  ///< (UT1 - UTC) less the leap seconds since 1980, 15 in 2011
  double ut1_rate = 0.0;           ///< rate of ut1_minus_gps_s, s/s
  double pole_x = 0.0;             ///< polar motion, rad
  double pole_y = 0.0;
};

/// Mean rate of the Earth rotation angle, rad/s of UT1 (IAU 2000).
inline constexpr double kEarthRotationRate = 7.292115146706979e-5;

/// Returns the rotation to ITRF from GCRF at a GPS time. With true orientation parameters the error stays below 1e-7
/// rad (0.02 arcsec, 0.7 m at LEO) from 2000 to 2040.
Matrix3 R_itrf_gcrf(GpsTime time, const EarthOrientation& orientation);

}  // namespace vbar::fsw::orbit
