#include "fsw/orbit/propagate.h"

#include "fsw/math/math.h"
#include "fsw/orbit/gravity_field.h"

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

namespace {

constexpr double kMaxStep = 10.0;  // s

// The polar radius: no valid orbit lies below it.
constexpr double kMinRadius = 6.35e6;  // m

CartesianState runge_kutta_4(const CartesianState& s, double h) {
  const Vector3& r = s.position_eci;
  const Vector3& v = s.velocity_eci;
  const Vector3 a1 = acceleration_j2(r);
  const Vector3 v2 = v + 0.5 * h * a1;
  const Vector3 a2 = acceleration_j2(r + 0.5 * h * v);
  const Vector3 v3 = v + 0.5 * h * a2;
  const Vector3 a3 = acceleration_j2(r + 0.5 * h * v2);
  const Vector3 v4 = v + h * a3;
  const Vector3 a4 = acceleration_j2(r + h * v3);
  return {.position_eci = r + h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4),
          .velocity_eci = v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)};
}

}  // namespace

Vector3 acceleration_j2(const Vector3& r) {
  const double r2 = r.squaredNorm();
  const double mu_over_r3 = kMu / (r2 * math::sqrt(r2));
  const double oblateness = 1.5 * kJ2 * kEarthRadius * kEarthRadius / r2;
  const double sin2_latitude = r.z() * r.z() / r2;
  const double equatorial = 1.0 + oblateness * (1.0 - 5.0 * sin2_latitude);
  const double polar = 1.0 + oblateness * (3.0 - 5.0 * sin2_latitude);
  return -mu_over_r3 * Vector3(equatorial * r.x(), equatorial * r.y(), polar * r.z());
}

Result<CartesianState> propagate_j2(const CartesianState& state, double dt) {
  const double check = state.position_eci.squaredNorm() + state.velocity_eci.squaredNorm() + dt;
  if (!math::is_finite(check)) return Status::kNotFinite;
  if (math::abs(dt) > kMaxCoast || state.position_eci.squaredNorm() < kMinRadius * kMinRadius)
    return Status::kOutOfRange;
  if (dt == 0.0) return state;

  const int steps = 1 + static_cast<int>(math::abs(dt) / kMaxStep * (1.0 - 1e-15));
  const double h = dt / steps;
  CartesianState s = state;
  for (int k = 0; k < steps; ++k) s = runge_kutta_4(s, h);
  if (!math::is_finite(s.position_eci.squaredNorm() + s.velocity_eci.squaredNorm())) return Status::kNotFinite;
  return s;
}

}  // namespace vbar::fsw::orbit
