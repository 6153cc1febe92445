#pragma once
// Quasi-nonsingular elements to position, velocity and the quantities the variational equations need, and back: the
// truth's own conversions, for any gravitational parameter, on the host's mathematics library.

#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"

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

}  // namespace vbar::truth
