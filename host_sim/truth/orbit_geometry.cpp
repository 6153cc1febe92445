#include "host_sim/truth/orbit_geometry.h"

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

}  // namespace vbar::truth
