#pragma once
// Quasi-nonsingular elements to position, velocity and the quantities the variational equations need, and back: the
// truth's own conversions, for any gravitational parameter, on the host's mathematics library.

#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "host_sim/truth/attitude/attitude_motion.h"

namespace vbar::truth {

/// An osculating orbit at one instant. SI and radians.
struct OrbitGeometry {
  fsw::orbit::CartesianState state;
  fsw::Matrix3 R_rtn_eci;  ///< rows R, T, N
  double r = 0.0;          ///< distance from the centre, m
  double p = 0.0;          ///< semi-latus rectum, m
  double h = 0.0;          ///< specific angular momentum, m^2/s
  double n = 0.0;          ///< mean motion, rad/s
  double eta = 0.0;        ///< sqrt(1 - e^2)
  double cos_theta = 0.0;  ///< cosine of the true argument of latitude
  double sin_theta = 0.0;
  double cos_i = 0.0;
  double sin_i = 0.0;
};

/// Returns the geometry of osculating elements under `gm` (m^3/s^2). Throws std::domain_error unless the orbit is an
/// ellipse (a > 0, e < 1).
OrbitGeometry orbit_geometry(const fsw::orbit::QnsElements& osculating, double gm);

/// Returns the osculating elements of an ECI state; raan and u in (-pi, pi]. Throws std::domain_error for an orbit that
/// is not an ellipse (parabolic, hyperbolic, rectilinear), that is equatorial (inclination within 1e-8 rad of 0 or pi,
/// where the elements are singular) or not finite.
fsw::orbit::QnsElements elements_from_cartesian(const fsw::orbit::CartesianState& state, double gm);

// Gauss variational equations in quasi-nonsingular elements: how a perturbing acceleration changes the osculating
// orbit.

/// Convert elements to the integrator's vector [a, ex, ey, i, raan, u], and back.
fsw::Vector6 vector_from_elements(const fsw::orbit::QnsElements& elements);
fsw::orbit::QnsElements elements_from_vector(const fsw::Vector6& vector);

/// Returns the time derivative of [a, ex, ey, i, raan, u] (SI and radians) under the perturbing acceleration (m/s^2, in
/// the spacecraft's RTN, without the point mass). `geometry` is that of `osculating`. Singular at inclination 0 and pi.
/// Source: Gauss's equations (e.g. Battin 1999, section 10.5) for ex = e cos w, ey = e sin w, u = w + M.
fsw::Vector6 gve_rates(const fsw::orbit::QnsElements& osculating, const OrbitGeometry& geometry,
                       const fsw::Vector3& perturbation_rtn);

// Motion a short time ahead without a step of an integrator: what acts beside the Earth's point mass is taken as
// constant.

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
