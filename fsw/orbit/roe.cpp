#include "fsw/orbit/roe.h"

#include "fsw/math/math.h"
#include "fsw/orbit/propagate.h"

namespace vbar::fsw::orbit {

Vector6 roe_from_qns(const QnsElements& chief, const QnsElements& deputy) {
  const double node_difference = math::wrap_to_pi(deputy.raan - chief.raan);
  Vector6 roe;
  roe(0) = (deputy.a - chief.a) / chief.a;
  roe(1) = math::wrap_to_pi(deputy.u - chief.u + node_difference * math::cos(chief.i));
  roe(2) = deputy.ex - chief.ex;
  roe(3) = deputy.ey - chief.ey;
  roe(4) = deputy.i - chief.i;
  roe(5) = node_difference * math::sin(chief.i);
  return roe;
}

QnsElements qns_from_roe(const QnsElements& chief, const Vector6& roe) {
  const double node_difference = roe(5) / math::sin(chief.i);
  return QnsElements{.a = chief.a * (1.0 + roe(0)),
                     .ex = chief.ex + roe(2),
                     .ey = chief.ey + roe(3),
                     .i = chief.i + roe(4),
                     .raan = chief.raan + node_difference,
                     .u = chief.u + roe(1) - node_difference * math::cos(chief.i)};
}

Matrix6 roe_transition_j2(const QnsElements& chief_mean, double tau) {
  const SecularRates rates = secular_rates(chief_mean);
  const double n = rates.mean_motion;
  const double kappa_tau = rates.kappa * tau;
  const double cos_i = math::cos(chief_mean.i);
  const double sin_i = math::sin(chief_mean.i);
  const double ex = chief_mean.ex;
  const double ey = chief_mean.ey;
  const double eta = math::sqrt(1.0 - ex * ex - ey * ey);

  // Notation of Koenig, Guffanti and D'Amico 2017.
  const double E = 1.0 + eta;
  const double F = 4.0 + 3.0 * eta;
  const double G = 1.0 / (eta * eta);
  const double P = 3.0 * cos_i * cos_i - 1.0;
  const double Q = 5.0 * cos_i * cos_i - 1.0;
  const double S = 2.0 * sin_i * cos_i;
  const double T = sin_i * sin_i;

  const double c = math::cos(rates.perigee * tau);
  const double s = math::sin(rates.perigee * tau);
  const double ex_f = ex * c - ey * s;
  const double ey_f = ex * s + ey * c;

  Matrix6 phi = Matrix6::Identity();
  phi(1, 0) = -1.5 * n * tau - 3.5 * kappa_tau * E * P;
  phi(1, 2) = kappa_tau * ex * F * G * P;
  phi(1, 3) = kappa_tau * ey * F * G * P;
  phi(1, 4) = -kappa_tau * F * S;
  phi(2, 0) = 3.5 * kappa_tau * ey_f * Q;
  phi(2, 2) = c - 4.0 * kappa_tau * ex * ey_f * G * Q;
  phi(2, 3) = -s - 4.0 * kappa_tau * ey * ey_f * G * Q;
  phi(2, 4) = 5.0 * kappa_tau * ey_f * S;
  phi(3, 0) = -3.5 * kappa_tau * ex_f * Q;
  phi(3, 2) = s + 4.0 * kappa_tau * ex * ex_f * G * Q;
  phi(3, 3) = c + 4.0 * kappa_tau * ey * ex_f * G * Q;
  phi(3, 4) = -5.0 * kappa_tau * ex_f * S;
  phi(5, 0) = 3.5 * kappa_tau * S;
  phi(5, 2) = -4.0 * kappa_tau * ex * G * S;
  phi(5, 3) = -4.0 * kappa_tau * ey * G * S;
  phi(5, 4) = 2.0 * kappa_tau * T;
  return phi;
}

Matrix63 roe_control_matrix(const QnsElements& chief) {
  const Result<InPlane> solved = in_plane(chief);
  if (!solved.ok()) return Matrix63::Constant(__builtin_nan(""));
  const auto [cos_theta, sin_theta, radius_over_a, eta] = solved.value();
  const double ex = chief.ex;
  const double ey = chief.ey;
  const double e_cos_f = ex * cos_theta + ey * sin_theta;
  const double e_sin_f = ex * sin_theta - ey * cos_theta;
  const double k = 1.0 + e_cos_f;  // p / r
  const double tan_i = math::tan(chief.i);

  Matrix63 gamma = Matrix63::Zero();
  gamma(0, 0) = 2.0 / eta * e_sin_f;
  gamma(0, 1) = 2.0 / eta * k;
  gamma(1, 0) = -eta * e_cos_f / (1.0 + eta) - 2.0 * eta * eta / k;
  gamma(1, 1) = eta * (1.0 + k) * e_sin_f / ((1.0 + eta) * k);
  gamma(2, 0) = eta * sin_theta;
  gamma(2, 1) = eta * ((1.0 + k) * cos_theta + ex) / k;
  gamma(2, 2) = eta * ey * sin_theta / (k * tan_i);
  gamma(3, 0) = -eta * cos_theta;
  gamma(3, 1) = eta * ((1.0 + k) * sin_theta + ey) / k;
  gamma(3, 2) = -eta * ex * sin_theta / (k * tan_i);
  gamma(4, 2) = eta * cos_theta / k;
  gamma(5, 2) = eta * sin_theta / k;
  return gamma / (mean_motion(chief.a) * chief.a);
}

Matrix63 roe_control_matrix_near_circular(const QnsElements& chief) {
  const double cos_u = math::cos(chief.u);
  const double sin_u = math::sin(chief.u);
  Matrix63 gamma = Matrix63::Zero();
  gamma.row(0) << 0.0, 2.0, 0.0;
  gamma.row(1) << -2.0, 0.0, 0.0;
  gamma.row(2) << sin_u, 2.0 * cos_u, 0.0;
  gamma.row(3) << -cos_u, 2.0 * sin_u, 0.0;
  gamma.row(4) << 0.0, 0.0, cos_u;
  gamma.row(5) << 0.0, 0.0, sin_u;
  return gamma / (mean_motion(chief.a) * chief.a);
}

Vector6 rtn_from_roe_linear(const QnsElements& chief, const Vector6& roe) {
  const double cos_u = math::cos(chief.u);
  const double sin_u = math::sin(chief.u);
  const double da = roe(0), dlambda = roe(1), dex = roe(2), dey = roe(3), dix = roe(4), diy = roe(5);
  Vector6 rtn;
  rtn(0) = da - dex * cos_u - dey * sin_u;
  rtn(1) = dlambda + 2.0 * dex * sin_u - 2.0 * dey * cos_u;
  rtn(2) = dix * sin_u - diy * cos_u;
  rtn(3) = dex * sin_u - dey * cos_u;
  rtn(4) = -1.5 * da + 2.0 * dex * cos_u + 2.0 * dey * sin_u;
  rtn(5) = dix * cos_u + diy * sin_u;
  rtn.head<3>() *= chief.a;
  rtn.tail<3>() *= chief.a * mean_motion(chief.a);
  return rtn;
}

Vector6 roe_from_rtn_linear(const QnsElements& chief, const Vector6& rtn) {
  const double cos_u = math::cos(chief.u);
  const double sin_u = math::sin(chief.u);
  const Vector3 x = rtn.head<3>() / chief.a;
  const Vector3 v = rtn.tail<3>() / (chief.a * mean_motion(chief.a));
  const double k = 3.0 * x(0) + 2.0 * v(1);  // dex cos u + dey sin u
  Vector6 roe;
  roe(0) = 4.0 * x(0) + 2.0 * v(1);
  roe(1) = x(1) - 2.0 * v(0);
  roe(2) = k * cos_u + v(0) * sin_u;
  roe(3) = k * sin_u - v(0) * cos_u;
  roe(4) = x(2) * sin_u + v(2) * cos_u;
  roe(5) = -x(2) * cos_u + v(2) * sin_u;
  return roe;
}

Result<CartesianState> target_from_roe(const QnsElements& chief, const Vector6& roe) {
  return cartesian_from_qns(qns_from_roe(chief, roe));
}

Result<Vector6> roe_of_target(const CartesianState& chief, const CartesianState& deputy) {
  const auto chief_elements = qns_from_cartesian(chief);
  const auto deputy_elements = qns_from_cartesian(deputy);
  if (!chief_elements.ok()) return chief_elements.status();
  if (!deputy_elements.ok()) return deputy_elements.status();
  return roe_from_qns(chief_elements.value(), deputy_elements.value());
}

namespace {

// A Newton step of this size leaves an error of e/2 (1e-8)^2 / (1-e) < 1e-15 rad, and moves sine and cosine so little
// that two terms of their series replace another evaluation.
constexpr double kLastStep = 1e-8;
constexpr int kMaxIterations = 20;

// From F = u Newton's method converges while the equation is nearly linear. Beyond, it starts at u + e or u - e, past
// the root on the side where the equation is convex, from where the convergence is monotone.
constexpr double kNearlyCircular = 0.1;

}  // namespace

Result<EccentricLatitude> solve_kepler(double ex, double ey, double u) {
  if (!math::is_finite(ex) || !math::is_finite(ey) || !math::is_finite(u)) return Status::kNotFinite;
  const double e = math::hypot(ex, ey);
  if (e > kMaxEccentricity) return Status::kOutOfRange;

  double angle = u;
  if (e > kNearlyCircular) angle += ex * math::sin(u) - ey * math::cos(u) >= 0.0 ? e : -e;
  for (int k = 0; k < kMaxIterations; ++k) {
    const double s = math::sin(angle);
    const double c = math::cos(angle);
    const double step = (u - angle + ex * s - ey * c) / (1.0 - ex * c - ey * s);
    angle += step;
    if (math::abs(step) < kLastStep) return EccentricLatitude{.sin = s + c * step, .cos = c - s * step, .angle = angle};
  }
  return Status::kDidNotConverge;
}

Result<InPlane> in_plane(const QnsElements& q) {
  const Result<EccentricLatitude> kepler = solve_kepler(q.ex, q.ey, q.u);
  if (!kepler.ok()) return kepler.status();
  const auto [s, c, angle] = kepler.value();
  const double eta = math::sqrt(1.0 - q.ex * q.ex - q.ey * q.ey);
  const double b = 1.0 / (1.0 + eta);
  const double radius_over_a = 1.0 - q.ex * c - q.ey * s;
  return InPlane{.cos_theta = ((1.0 - b * q.ey * q.ey) * c + b * q.ex * q.ey * s - q.ex) / radius_over_a,
                 .sin_theta = ((1.0 - b * q.ex * q.ex) * s + b * q.ex * q.ey * c - q.ey) / radius_over_a,
                 .radius_over_a = radius_over_a,
                 .eta = eta};
}

}  // namespace vbar::fsw::orbit
