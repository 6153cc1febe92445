#pragma once
// Geodetic coordinates on the WGS 84 ellipsoid.

#include "fsw/core/types.h"

namespace vbar::truth {

struct GeodeticPosition {
  double latitude = 0.0;   ///< rad, -pi/2 to pi/2
  double longitude = 0.0;  ///< rad, -pi to pi; 0 on the axis
  double altitude = 0.0;   ///< m, above the ellipsoid
};

/// Returns geodetic coordinates from a position in ITRF, m, more than 100 km from the Earth's centre. Bowring's formula
/// (1976) applied twice: errors below 1e-14 rad and 1e-8 m from the ground to geostationary (held by its test). A
/// position that is not finite gives NaNs.
GeodeticPosition geodetic_from_itrf(const fsw::Vector3& position_itrf);

}  // namespace vbar::truth
