#pragma once
// Relative orbital elements (D'Amico 2010): deputy with respect to chief, dimensionless,
// [da, dlambda, dex, dey, dix, diy]. In this project chief = servicer, deputy = target, as in the paper's waypoint
// table: a burn of the servicer therefore changes them by MINUS the control matrix.

#include "fsw/orbit/elements.h"

namespace vbar::fsw::orbit {

/// ROE of `deputy` with respect to `chief`; both mean or both osculating. dlambda and the node difference are in (-pi,
/// pi].
Vector6 roe_from_qns(const QnsElements& chief, const QnsElements& deputy);

/// Exact inverse: the deputy's elements.
QnsElements qns_from_roe(const QnsElements& chief, const Vector6& roe);

/// The deputy's state from its osculating ROE with respect to the chief, and back. Errors of the conversions of
/// elements.
Result<CartesianState> target_from_roe(const QnsElements& chief, const Vector6& roe);
Result<Vector6> roe_of_target(const CartesianState& chief, const CartesianState& deputy);

/// 6x6 state-transition matrix of mean ROE over tau seconds under J2 (Koenig, Guffanti, D'Amico 2017, eq. A6);
/// `chief_mean` at the start of the interval.
Matrix6 roe_transition_j2(const QnsElements& chief_mean, double tau);

/// 6x3 change of the ROE per impulse [R,T,N] (m/s) of the DEPUTY, exact for any e (Gauss variational equations);
/// negate for the chief (servicer). `chief` must be valid elements (0 <= e <= 0.95, inclined); NaN otherwise.
Matrix63 roe_control_matrix(const QnsElements& chief);

/// The same to O(e): what the closed-form solvers and hand checks use. Relative error about e.
Matrix63 roe_control_matrix_near_circular(const QnsElements& chief);

/// Linear near-circular map (Hill-Clohessy-Wiltshire as ROE): relative position (m) and velocity (m/s) of the deputy in
/// the chief's RTN, stacked.
Vector6 rtn_from_roe_linear(const QnsElements& chief, const Vector6& roe);

/// Inverse of rtn_from_roe_linear.
Vector6 roe_from_rtn_linear(const QnsElements& chief, const Vector6& rtn);

}  // namespace vbar::fsw::orbit
