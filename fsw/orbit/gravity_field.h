#pragma once
// The Earth's attraction as flight software takes it where J2 is not enough: degree and order 20. What lies beyond
// turns within five minutes of a low orbit and parts two spacecraft 75 km from each other by half a metre in six hours.

#include "fsw/core/types.h"

namespace vbar::fsw::orbit {

/// Gravitational acceleration, m/s^2 in ITRF, point mass included, at a position (m, ITRF) outside the Earth; not the
/// centre. Cunningham (1970): each component of the gradient is a harmonic series of one degree more; Legendre
/// functions divided by cos^m(latitude) (Pines 1973), so the poles are points like any other. Some 4,000 operations.
Vector3 gravity_itrf(const Vector3& position_itrf);

}  // namespace vbar::fsw::orbit
