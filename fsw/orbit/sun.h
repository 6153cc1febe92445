#pragma once
// Where the Sun is and how fast the Earth moves, as a flight computer knows them: mean elements of the barycentre of
// Earth and Moon (Standish 1992, Keplerian elements for approximate positions of the major planets), the largest
// perturbations by Venus and Jupiter (Meeus 1982, chapter 18), the Earth's swing about that barycentre and the Sun's
// about its own.

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"

namespace vbar::fsw::orbit {

/// Sun from the Earth's centre in GCRF, m, geometric: seen, it stands 20 arcsec behind. Over 2000 to 2040 its direction
/// is good to 15 arcsec, its distance to 1e-4.
Vector3 sun_position_gcrf(GpsTime time);

/// Velocity of the Earth's centre against the solar system's barycentre in GCRF over the speed of light: what makes the
/// stars' aberration. To 3e-8 (0.006 arcsec) over 2000 to 2040.
Vector3 earth_velocity_over_c_gcrf(GpsTime time);

}  // namespace vbar::fsw::orbit
