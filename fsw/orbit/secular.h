#pragma once
// Secular J2 motion of mean elements (Brouwer 1959, first order), with kappa = 3/4 J2 n (Re / (a eta^2))^2:
//
//   raan' = -2 kappa cos i,  w' = kappa (5 cos^2 i - 1),  M' = n + kappa eta (3 cos^2 i - 1).

#include "fsw/orbit/elements.h"

namespace vbar::fsw::orbit {

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

}  // namespace vbar::fsw::orbit
