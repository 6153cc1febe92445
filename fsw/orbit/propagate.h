#pragma once
// Short numerical propagation on board, between measurements or through an outage:
//
//   r'' = -mu/r^3 [(1 + k (1 - 5 s^2)) x, (1 + k (1 - 5 s^2)) y, (1 + k (3 - 5 s^2)) z],
//   k = 3/2 J2 (Re/r)^2,  s = z/r (sine of the latitude).

#include "fsw/orbit/elements.h"

namespace vbar::fsw::orbit {

/// Longest interval that propagate_j2 accepts, s.
inline constexpr double kMaxCoast = 7200.0;

/// Returns the ECI acceleration, m/s^2, of point mass and J2 at an ECI position (m), which must not be zero. The polar
/// axis is assumed to be ECI z (J2000), which over decades misaligns the axis of J2 by arc minutes.
Vector3 acceleration_j2(const Vector3& position_eci);

/// Returns the state `dt` seconds later (or earlier) under point mass and J2: classical Runge-Kutta 4 with equal steps
/// of at most 10 s. Truncation error in low Earth orbit is under 2 mm after 10 minutes and 30 cm after 2 hours; the
/// neglected forces matter more. kOutOfRange for |dt| > kMaxCoast or a position inside the Earth at the start;
/// kNotFinite.
Result<CartesianState> propagate_j2(const CartesianState& state, double dt);

}  // namespace vbar::fsw::orbit
