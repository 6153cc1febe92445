#pragma once
// Motion a short time ahead without a step of an integrator: what acts beside the Earth's point mass is taken as
// constant.

#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "host_sim/truth/attitude/attitude_state.h"

namespace vbar::truth {

/// Returns the acceleration by a point mass at the origin; gm in m^3/s^2.
[[nodiscard]] fsw::Vector3 central_acceleration(double gm, const fsw::Vector3& position_eci);

/// Returns the state `seconds` later under the point mass and a constant perturbation (m/s^2), by one step of the
/// classical Runge-Kutta method of fourth order: over a second of a low orbit its own error is far below a nanometre,
/// over 10 s some micrometres.
[[nodiscard]] fsw::orbit::CartesianState orbit_ahead(const fsw::orbit::CartesianState& state, double gm,
                                                     const fsw::Vector3& perturbation_eci, double seconds);

/// Returns the attitude `seconds` later with a constant angular acceleration (rad/s^2, body axes).
[[nodiscard]] AttitudeState attitude_ahead(AttitudeState attitude, const fsw::Vector3& angular_acceleration_body,
                                           double seconds);

}  // namespace vbar::truth
