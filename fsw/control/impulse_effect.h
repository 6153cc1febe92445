#pragma once
// What an impulse at one time does to the mean ROE at a later time: the columns every solver plans with.

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::control {

/// kOk if the chief's mean elements and the time to the arrival (s) are within what the maps below are valid for:
/// 0 <= e < 0.9, sin i > 1e-6, perigee above the ground, 0 <= horizon <= 30 days; else kNotFinite or kOutOfRange.
Status check_horizon(const orbit::QnsElements& chief_mean, double horizon);

/// 6x3 change of the dimensionless mean ROE at `horizon` per impulse [R,T,N] (m/s) of the DEPUTY at `t`, both in
/// seconds after the epoch of `chief_mean`: Phi(horizon - t) Gamma(t) with the J2 transition matrix and mean elements
/// in the control matrix (the Jacobian of mean with respect to osculating elements, 1 + O(J2), is neglected). Finite if
/// check_horizon is kOk.
Matrix63 impulse_effect(const orbit::QnsElements& chief_mean, double t, double horizon);

}  // namespace vbar::fsw::control
