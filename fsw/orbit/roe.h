#pragma once
// Relative orbital elements (ROE; D'Amico 2010): deputy with respect to chief, dimensionless,
//
//   [da, dlambda, dex, dey, dix, diy] = [(a_d - a)/a, u_d - u + (raan_d - raan) cos i, ex_d - ex, ey_d - ey,
//                                       i_d - i, (raan_d - raan) sin i].
//
// In this project chief = servicer, deputy = target, as in the paper's waypoint table: a burn of the servicer therefore
// changes them by MINUS the control matrix.

#include "fsw/orbit/elements.h"

namespace vbar::fsw::orbit {

/// Returns the ROE of `deputy` with respect to `chief`; both sets of elements are mean or both osculating. dlambda and
/// the node difference are in (-pi, pi].
Vector6 roe_from_qns(const QnsElements& chief, const QnsElements& deputy);

/// Returns the deputy's elements: the exact inverse.
QnsElements qns_from_roe(const QnsElements& chief, const Vector6& roe);

/// Returns the deputy's state from its osculating ROE with respect to the chief, and the ROE from both states. Errors
/// are those of the conversions of elements.
Result<CartesianState> target_from_roe(const QnsElements& chief, const Vector6& roe);
Result<Vector6> roe_of_target(const CartesianState& chief, const CartesianState& deputy);

/// Returns the 6x6 state-transition matrix of mean ROE over tau seconds under J2 (Koenig, Guffanti, D'Amico 2017, eq.
/// A6); `chief_mean` is at the start of the interval.
Matrix6 roe_transition_j2(const QnsElements& chief_mean, double tau);

/// Returns the 6x3 change of the ROE per impulse [R,T,N] (m/s) of the DEPUTY, exact for any e (Gauss variational
/// equations); negate for the chief (servicer). `chief` must be valid elements (0 <= e <= 0.95, inclined); NaN
/// otherwise.
Matrix63 roe_control_matrix(const QnsElements& chief);

/// Returns the same matrix for e = 0, as the closed-form solvers and hand checks use it. Its relative error is about e.
Matrix63 roe_control_matrix_near_circular(const QnsElements& chief);

/// Returns the relative position (m) and velocity (m/s) of the deputy in the chief's RTN, stacked, by the linear
/// near-circular map (Hill-Clohessy-Wiltshire as ROE):
///   x_R / a = da - dex cos u - dey sin u,   x_T / a = dlambda + 2 dex sin u - 2 dey cos u,
///   x_N / a = dix sin u - diy cos u, and their time derivatives for u' = n, dlambda' = -3/2 n da.
Vector6 rtn_from_roe_linear(const QnsElements& chief, const Vector6& roe);

/// Returns the ROE of such a relative state: the inverse of rtn_from_roe_linear.
Vector6 roe_from_rtn_linear(const QnsElements& chief, const Vector6& rtn);

// Position of a spacecraft in its orbital plane, from QNS elements, without the argument of perigee: regular at e = 0.

/// Largest eccentricity that the orbit functions accept.
inline constexpr double kMaxEccentricity = 0.95;

/// Root F = w + E of Kepler's equation in QNS form, u = F - ex sin F + ey cos F, with its sine and cosine.
struct EccentricLatitude {
  double sin = 0.0;
  double cos = 1.0;
  double angle = 0.0;  ///< rad, within e of u
};

/// Solves Kepler's equation for e = |(ex, ey)| <= kMaxEccentricity and finite u (rad). Newton's method, error under
/// 1e-15 rad for |u| < pi; kDidNotConverge after 20 iterations, kOutOfRange for a larger e, kNotFinite.
Result<EccentricLatitude> solve_kepler(double ex, double ey, double u);

/// Direction of the position in the plane, axis x to the ascending node, axis y 90 deg ahead.
struct InPlane {
  double cos_theta = 1.0;  ///< theta is the true argument of latitude, w + f
  double sin_theta = 0.0;
  double radius_over_a = 1.0;  ///< r/a
  double eta = 1.0;            ///< sqrt(1 - e^2)
};

/// Returns the position in the plane for valid elements, otherwise an error of solve_kepler.
Result<InPlane> in_plane(const QnsElements& elements);

}  // namespace vbar::fsw::orbit
