#pragma once
// Short numerical propagation on board, between measurements or through an outage:
//
//   r'' = -mu/r^3 [(1 + k (1 - 5 s^2)) x, (1 + k (1 - 5 s^2)) y, (1 + k (3 - 5 s^2)) z],
//   k = 3/2 J2 (Re/r)^2,  s = z/r (sine of the latitude).

#include "fsw/orbit/elements.h"

namespace vbar::fsw::orbit {

// Secular J2 motion of mean elements (Brouwer 1959, first order), with kappa = 3/4 J2 n (Re / (a eta^2))^2:
//
//   raan' = -2 kappa cos i,  w' = kappa (5 cos^2 i - 1),  M' = n + kappa eta (3 cos^2 i - 1).

/// Rates of mean elements under J2, rad/s.
struct SecularRates {
  double mean_motion = 0.0;   ///< Keplerian n
  double raan = 0.0;          ///< node
  double perigee = 0.0;       ///< argument of perigee
  double mean_anomaly = 0.0;  ///< n plus the J2 part
  double kappa = 0.0;         ///< (3/4) J2 Re^2 sqrt(mu) / (a^(7/2) eta^4)
  /// Returns d(w+M)/dt.
  [[nodiscard]] double mean_argument_of_latitude() const { return perigee + mean_anomaly; }
};

SecularRates secular_rates(const QnsElements& mean);

/// Returns the mean elements `dt` seconds later (or earlier); u grows without wrapping.
QnsElements propagate_secular(const QnsElements& mean, double dt);

/// Longest interval that propagate_j2 accepts, s.
inline constexpr double kMaxCoast = 7200.0;

/// Returns the ECI acceleration, m/s^2, of point mass and J2 at an ECI position (m), which must not be zero. The polar
/// axis is assumed to be ECI z (J2000), which over decades misaligns the axis of J2 by arc minutes.
Vector3 acceleration_j2(const Vector3& position_eci);

/// Returns the state `dt` seconds later (or earlier) under point mass and J2: classical Runge-Kutta 4 with equal steps
/// of at most 10 s. Truncation error in low Earth orbit is under 2 mm after 10 minutes and 30 cm after 2 hours; the
/// neglected forces matter more. kOutOfRange for |dt| > kMaxCoast or a position inside the Earth at the start;
/// kNotFinite.
Result<CartesianState> propagate_j2(const CartesianState& state, double dt);

}  // namespace vbar::fsw::orbit
