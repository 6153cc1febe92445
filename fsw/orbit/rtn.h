#pragma once
// The radial-transverse-normal frame of a spacecraft: R along the position, N along the angular momentum, T = N x R
// (T is not along the velocity if the orbit is eccentric).

#include "fsw/orbit/elements.h"

namespace vbar::fsw::orbit {

/// Returns the rotation to the RTN frame of `state` from ECI: rows R, T, N. `state` must not be rectilinear.
Matrix3 R_rtn_eci(const CartesianState& state);

/// Position (m) and velocity (m/s, as seen in the rotating frame, rate h/r^2 about N) of the deputy in the chief's RTN.
struct RelativeState {
  Vector3 position_rtn = Vector3::Zero();
  Vector3 velocity_rtn = Vector3::Zero();
};

RelativeState relative_state_rtn(const CartesianState& chief, const CartesianState& deputy);

/// Returns the state after an impulse, which is given in the spacecraft's own RTN frame (m/s).
CartesianState apply_impulse_rtn(const CartesianState& state, const Vector3& dv_rtn);

/// Returns the RTN state of the deputy defined by MEAN roe about the chief's MEAN elements: exact, through both
/// osculating states.
Result<RelativeState> relative_state_from_mean_roe(const QnsElements& chief_mean, const Vector6& mean_roe);

}  // namespace vbar::fsw::orbit
