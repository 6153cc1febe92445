#pragma once
// What filters propagate with: a spacecraft under point mass and J2, pushed by a constant acceleration in its own RTN.

#include "fsw/orbit/elements.h"

namespace vbar::fsw::navigation {

/// The state `dt` (s, either sign, at most an hour) later; `acceleration_rtn` (m/s^2) is turned with the orbit.
/// Classical Runge-Kutta 4, steps of at most 10 s: truncation below a micrometre a step. The caller answers for finite
/// input.
orbit::CartesianState propagate_pushed(const orbit::CartesianState& state, const Vector3& acceleration_rtn, double dt);

}  // namespace vbar::fsw::navigation
