#pragma once
// Short numerical propagation on board, between measurements or through an outage.

#include "fsw/orbit/elements.h"

namespace vbar::fsw::orbit {

/// Longest interval that propagate_j2 accepts, s.
inline constexpr double kMaxCoast = 7200.0;

/// ECI acceleration, m/s^2, of a point mass and J2 at an ECI position (m); the polar axis is taken as ECI z (J2000),
/// which over decades misaligns the axis of J2 by arc minutes. `position_eci` must not be zero.
Vector3 acceleration_j2(const Vector3& position_eci);

/// The state `dt` seconds later (or earlier) under point mass and J2: classical Runge-Kutta 4 with equal steps of at
/// most 10 s. Truncation error in low Earth orbit under 2 mm after 10 minutes and 30 cm after 2 hours; the neglected
/// forces matter more. kOutOfRange for |dt| > kMaxCoast or a position inside the Earth at the start; kNotFinite.
Result<CartesianState> propagate_j2(const CartesianState& state, double dt);

}  // namespace vbar::fsw::orbit
