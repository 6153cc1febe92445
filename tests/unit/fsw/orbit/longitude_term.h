#pragma once
// The first-order term of the mean longitude, g2'/4 e eta^2/(1+eta) [...], that Schaub & Junkins (F.11) and the
// programs made after it lack. Oracles that were computed without it become comparable by adding it.

#include <cmath>

#include "fsw/orbit/elements.h"
#include "fsw/orbit/gravity_field.h"

namespace vbar::fsw::orbit {

/// Its contribution to the osculating w + M + raan, rad, for mean elements.
inline double longitude_term(const QnsElements& mean) {
  const double e = std::hypot(mean.ex, mean.ey);
  const double w = std::atan2(mean.ey, mean.ex);
  const double f = true_argument_of_latitude(mean) - w;
  const double eta = std::sqrt(1.0 - e * e);
  const double g2p = 0.5 * kJ2 * std::pow(kEarthRadius / mean.a, 2) / std::pow(eta, 4);
  const double c2 = std::pow(std::cos(mean.i), 2);
  const double ar = (1.0 + e * std::cos(f)) / (eta * eta);
  const double y = ar * ar * eta * eta + ar;
  const double bracket =
      2.0 * (3.0 * c2 - 1.0) * (y + 1.0) * std::sin(f) +
      3.0 * (1.0 - c2) * ((1.0 - y) * std::sin(2.0 * w + f) + (y + 1.0 / 3.0) * std::sin(2.0 * w + 3.0 * f));
  return 0.25 * g2p * e * eta * eta / (1.0 + eta) * bracket;
}

}  // namespace vbar::fsw::orbit
