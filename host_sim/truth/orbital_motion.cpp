#include "host_sim/truth/orbital_motion.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace vbar::truth {

namespace {

using fsw::Vector3;

constexpr double kSmallestSineOfInclination = 1e-8;

struct SineCosine {
  double sine, cosine;
};

/// Eccentric argument of latitude F of F - ex sin F + ey cos F = u. Newton's method from a start correct to first
/// order in the eccentricity converges in a few iterations for near-circular orbits, and the bound covers e up to 0.99.
SineCosine solve_kepler(double ex, double ey, double u) {
  constexpr int kMaxIterations = 50;
  double f = u + ex * std::sin(u) - ey * std::cos(u);
  if (ex * ex + ey * ey > 0.25) f = u;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const double sine = std::sin(f), cosine = std::cos(f);
    const double slope = 1.0 - ex * cosine - ey * sine;
    const double correction = (f - ex * sine + ey * cosine - u) / slope;
    f -= correction;
    // The error left is of the order of the square of the correction, below rounding when the correction is below 1e-9.
    if (std::abs(correction) < 1e-9) return {sine - correction * cosine, cosine + correction * sine};
  }
  throw std::domain_error(fmt::format(
      "the orbit is not an ellipse clear of a parabola: eccentricity {} (Kepler's equation did not converge)",
      std::hypot(ex, ey)));
}

}  // namespace

OrbitGeometry orbit_geometry(const fsw::orbit::QnsElements& q, double gm) {
  const double e_squared = q.ex * q.ex + q.ey * q.ey;
  if (!(q.a > 0.0 && e_squared < 1.0)) {
    throw std::domain_error(
        fmt::format("the orbit is not an ellipse: semi-major axis {} m, eccentricity {}", q.a, std::sqrt(e_squared)));
  }
  const auto [sin_f, cos_f] = solve_kepler(q.ex, q.ey, q.u);
  OrbitGeometry g;
  g.eta = std::sqrt(1.0 - e_squared);
  g.n = std::sqrt(gm / q.a) / q.a;
  g.p = q.a * (1.0 - e_squared);
  g.h = g.n * q.a * q.a * g.eta;
  g.r = q.a * (1.0 - q.ex * cos_f - q.ey * sin_f);

  // In the orbital plane, first axis towards the ascending node.
  const double b = 1.0 / (1.0 + g.eta);
  const double x = q.a * ((1.0 - b * q.ey * q.ey) * cos_f + b * q.ex * q.ey * sin_f - q.ex);
  const double y = q.a * ((1.0 - b * q.ex * q.ex) * sin_f + b * q.ex * q.ey * cos_f - q.ey);
  const double speed_scale = g.n * q.a * q.a / g.r;
  const double x_rate = speed_scale * (b * q.ex * q.ey * cos_f - (1.0 - b * q.ey * q.ey) * sin_f);
  const double y_rate = speed_scale * ((1.0 - b * q.ex * q.ex) * cos_f - b * q.ex * q.ey * sin_f);
  g.cos_theta = x / g.r;
  g.sin_theta = y / g.r;

  g.cos_i = std::cos(q.i);
  g.sin_i = std::sin(q.i);
  const double cos_raan = std::cos(q.raan), sin_raan = std::sin(q.raan);
  const Vector3 to_node(cos_raan, sin_raan, 0.0);
  const Vector3 ahead_of_node(-sin_raan * g.cos_i, cos_raan * g.cos_i, g.sin_i);
  g.state.position_eci = x * to_node + y * ahead_of_node;
  g.state.velocity_eci = x_rate * to_node + y_rate * ahead_of_node;
  g.R_rtn_eci.row(0) = (g.cos_theta * to_node + g.sin_theta * ahead_of_node).transpose();
  g.R_rtn_eci.row(1) = (g.cos_theta * ahead_of_node - g.sin_theta * to_node).transpose();
  g.R_rtn_eci.row(2) << sin_raan * g.sin_i, -cos_raan * g.sin_i, g.cos_i;
  return g;
}

fsw::orbit::QnsElements elements_from_cartesian(const fsw::orbit::CartesianState& state, double gm) {
  const Vector3& r_eci = state.position_eci;
  const Vector3& v_eci = state.velocity_eci;
  const double r = r_eci.norm();
  const Vector3 momentum = r_eci.cross(v_eci);
  const double h = momentum.norm();
  const double a = 1.0 / (2.0 / r - v_eci.squaredNorm() / gm);
  if (!(std::isfinite(a) && a > 0.0 && h > 0.0)) {
    throw std::domain_error(
        fmt::format("the orbit is not an ellipse: at distance {} m with speed {} m/s (escape speed there: {} m/s)", r,
                    v_eci.norm(), std::sqrt(2.0 * gm / r)));
  }
  const Vector3 normal = momentum / h;
  const double sin_i = std::hypot(normal.x(), normal.y());
  if (!(sin_i > kSmallestSineOfInclination)) {
    throw std::domain_error("the orbit is equatorial: quasi-nonsingular elements are singular there");
  }
  const Vector3 to_node(-normal.y() / sin_i, normal.x() / sin_i, 0.0);
  const Vector3 ahead_of_node = normal.cross(to_node);
  const Vector3 eccentricity = v_eci.cross(momentum) / gm - r_eci / r;

  fsw::orbit::QnsElements q;
  q.a = a;
  q.ex = eccentricity.dot(to_node);
  q.ey = eccentricity.dot(ahead_of_node);
  q.i = std::atan2(sin_i, normal.z());
  q.raan = std::atan2(normal.x(), -normal.y());
  const double e_squared = q.ex * q.ex + q.ey * q.ey;
  if (!(e_squared < 1.0)) throw std::domain_error("the orbit is not an ellipse: it falls straight to the centre");
  const double eta = std::sqrt(1.0 - e_squared);
  const double b = 1.0 / (1.0 + eta);
  const double x = r_eci.dot(to_node), y = r_eci.dot(ahead_of_node);
  const double cos_f = q.ex + ((1.0 - b * q.ex * q.ex) * x - b * q.ex * q.ey * y) / (a * eta);
  const double sin_f = q.ey + ((1.0 - b * q.ey * q.ey) * y - b * q.ex * q.ey * x) / (a * eta);
  const double u = std::atan2(sin_f, cos_f) - q.ex * sin_f + q.ey * cos_f;
  q.u = std::remainder(u, 2.0 * M_PI);
  return q;
}

fsw::Vector6 vector_from_elements(const fsw::orbit::QnsElements& q) {
  fsw::Vector6 vector;
  vector << q.a, q.ex, q.ey, q.i, q.raan, q.u;
  return vector;
}

fsw::orbit::QnsElements elements_from_vector(const fsw::Vector6& vector) {
  return {vector[0], vector[1], vector[2], vector[3], vector[4], vector[5]};
}

fsw::Vector6 gve_rates(const fsw::orbit::QnsElements& q, const OrbitGeometry& g, const fsw::Vector3& perturbation_rtn) {
  const double f_r = perturbation_rtn.x(), f_t = perturbation_rtn.y(), f_n = perturbation_rtn.z();
  const double c = g.cos_theta, s = g.sin_theta;
  const double e_cos = q.ex * c + q.ey * s;  // e cos(true anomaly)
  const double e_sin = q.ex * s - q.ey * c;  // e sin(true anomaly)
  const double per_h = 1.0 / g.h;
  const double node_rate = g.r * s * per_h / g.sin_i * f_n;
  const double node_turn = node_rate * g.cos_i;  // the node's motion seen in the orbital plane

  fsw::Vector6 rates;
  rates[0] = 2.0 * q.a * q.a * per_h * (e_sin * f_r + (1.0 + e_cos) * f_t);
  rates[1] = per_h * (g.p * s * f_r + ((g.p + g.r) * c + g.r * q.ex) * f_t) + q.ey * node_turn;
  rates[2] = per_h * (-g.p * c * f_r + ((g.p + g.r) * s + g.r * q.ey) * f_t) - q.ex * node_turn;
  rates[3] = g.r * c * per_h * f_n;
  rates[4] = node_rate;
  rates[5] =
      g.n - node_turn +
      per_h * (-(g.p * e_cos / (1.0 + g.eta) + 2.0 * g.eta * g.r) * f_r + (g.p + g.r) * e_sin / (1.0 + g.eta) * f_t);
  return rates;
}

Vector3 central_acceleration(double gm, const Vector3& position_eci) {
  const double r = position_eci.norm();
  return -gm / (r * r * r) * position_eci;
}

fsw::orbit::CartesianState orbit_ahead(const fsw::orbit::CartesianState& state, double gm,
                                       const Vector3& perturbation_eci, double seconds) {
  const auto acceleration = [&](const Vector3& r) -> Vector3 { return central_acceleration(gm, r) + perturbation_eci; };
  const double h = seconds;
  const Vector3 &r = state.position_eci, &v = state.velocity_eci;
  const Vector3 a1 = acceleration(r);
  const Vector3 a2 = acceleration(r + h / 2.0 * v);
  const Vector3 a3 = acceleration(r + h / 2.0 * v + h * h / 4.0 * a1);
  const Vector3 a4 = acceleration(r + h * v + h * h / 2.0 * a2);
  fsw::orbit::CartesianState ahead;
  ahead.position_eci = r + h * v + h * h / 6.0 * (a1 + a2 + a3);
  ahead.velocity_eci = v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  return ahead;
}

AttitudeState attitude_ahead(AttitudeState attitude, const Vector3& angular_acceleration_body, double seconds) {
  const Vector3 turn = seconds * attitude.rate_body + 0.5 * seconds * seconds * angular_acceleration_body;
  const double angle = turn.norm();
  if (angle > 0.0)
    attitude.q_body_eci = Eigen::Quaterniond(Eigen::AngleAxisd(-angle, turn / angle)) * attitude.q_body_eci;
  attitude.rate_body += seconds * angular_acceleration_body;
  return attitude;
}

}  // namespace vbar::truth
