#pragma once
// Velocity of the Earth, for the aberration of stars.

#include "fsw/core/types.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::truth {

/// Returns the barycentric velocity, m/s, along the axes of GCRF, by eraEpv00. The series asks for TDB; TT differs by
/// less than 2 ms, in which the velocity rotates by 4e-10.
fsw::Vector3 earth_velocity_bcrs(JulianDate tt);

}  // namespace vbar::truth
