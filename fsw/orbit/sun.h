#pragma once
// On-board ephemeris of the Sun and velocity of the Earth. Model: mean elements of the barycentre of Earth and Moon
// (Standish 1992, Keplerian elements for approximate positions of the major planets), the largest perturbations by
// Venus and Jupiter (Meeus 1982, chapter 18), the motion of the Earth about that barycentre, and the motion of the Sun
// about the barycentre of the solar system.

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"

namespace vbar::fsw::orbit {

/// Returns the geometric position of the Sun from the Earth's centre in GCRF, m; the apparent direction lags by 20
/// arcsec. From 2000 to 2040 the direction is accurate to 15 arcsec, the distance to 1e-4.
Vector3 sun_position_gcrf(GpsTime time);

/// Returns the velocity of the Earth's centre with respect to the solar-system barycentre in GCRF over the speed of
/// light, as stellar aberration needs it. Accurate to 3e-8 (0.006 arcsec) from 2000 to 2040.
Vector3 earth_velocity_over_c_gcrf(GpsTime time);

}  // namespace vbar::fsw::orbit
