#pragma once
// Quasi-nonsingular (QNS) orbital elements and inertial states.
// q = [a, ex, ey, i, raan, u] with ex = e cos w, ey = e sin w, u = w + M: regular at e = 0, singular only at i = 0 and
// pi.

#include "fsw/core/result.h"
#include "fsw/core/types.h"

namespace vbar::fsw::orbit {

/// Position m and velocity m/s in ECI (GCRF).
struct CartesianState {
  Vector3 position_eci = Vector3::Zero();
  Vector3 velocity_eci = Vector3::Zero();
};

/// QNS elements, osculating or mean as the variable's name says; SI and radians.
struct QnsElements {
  double a = 0.0;     ///< semi-major axis, m
  double ex = 0.0;    ///< e cos(argument of perigee)
  double ey = 0.0;    ///< e sin(argument of perigee)
  double i = 0.0;     ///< inclination
  double raan = 0.0;  ///< right ascension of the ascending node
  double u = 0.0;     ///< MEAN argument of latitude, w + M
};

/// Returns the mean motion sqrt(mu / a^3), rad/s, of a Keplerian orbit with semi-major axis a (m, > 0).
double mean_motion(double a);

/// Returns the true argument of latitude, rad in (-pi, pi]; NaN for invalid elements (e > 0.95, not finite).
double true_argument_of_latitude(const QnsElements& elements);

/// Returns the ECI state of osculating elements. kOutOfRange unless 0 <= e <= 0.95, a > 0; kNotFinite; kDidNotConverge
/// (Kepler).
Result<CartesianState> cartesian_from_qns(const QnsElements& osculating);

/// Returns the osculating elements of an ECI state, raan and u in (-pi, pi]. kOutOfRange for orbits that are unbound,
/// rectilinear, equatorial (sin i < 1e-8) or have e > 0.95; kNotFinite.
Result<QnsElements> qns_from_cartesian(const CartesianState& state);

}  // namespace vbar::fsw::orbit
