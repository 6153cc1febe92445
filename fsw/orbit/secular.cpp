#include "fsw/orbit/secular.h"

#include "fsw/math/math.h"
#include "fsw/orbit/constants.h"

namespace vbar::fsw::orbit {

SecularRates secular_rates(const QnsElements& mean) {
  const double n = mean_motion(mean.a);
  const double eta_squared = 1.0 - mean.ex * mean.ex - mean.ey * mean.ey;
  const double radii = kEarthRadius / (mean.a * eta_squared);
  const double kappa = 0.75 * kJ2 * n * radii * radii;
  const double cos_i = math::cos(mean.i);
  return SecularRates{.mean_motion = n,
                      .raan = -2.0 * kappa * cos_i,
                      .perigee = kappa * (5.0 * cos_i * cos_i - 1.0),
                      .mean_anomaly = n + kappa * math::sqrt(eta_squared) * (3.0 * cos_i * cos_i - 1.0),
                      .kappa = kappa};
}

QnsElements propagate_secular(const QnsElements& mean, double dt) {
  const SecularRates rates = secular_rates(mean);
  const double cos_angle = math::cos(rates.perigee * dt);
  const double sin_angle = math::sin(rates.perigee * dt);
  return QnsElements{.a = mean.a,
                     .ex = mean.ex * cos_angle - mean.ey * sin_angle,
                     .ey = mean.ex * sin_angle + mean.ey * cos_angle,
                     .i = mean.i,
                     .raan = mean.raan + rates.raan * dt,
                     .u = mean.u + rates.mean_argument_of_latitude() * dt};
}

}  // namespace vbar::fsw::orbit
