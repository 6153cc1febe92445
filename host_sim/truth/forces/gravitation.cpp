#include "host_sim/truth/forces/gravitation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "host_sim/truth/earth/sun_moon.h"

namespace vbar::truth {

namespace {

/// Fully normalised coefficients of one Cartesian component of the acceleration, in units of GM/R^2.
struct ComponentSeries {
  explicit ComponentSeries(int degree) : c(GravityCoefficients::index(degree + 1, 0)), s(c.size()) {}

  void add(int n, int m, double c_term, double s_term) {
    c[GravityCoefficients::index(n, m)] += c_term;
    s[GravityCoefficients::index(n, m)] += s_term;
  }

  std::vector<double> c, s;
};

struct Gradient {
  explicit Gradient(int degree) : x(degree), y(degree), z(degree) {}
  ComponentSeries x, y, z;
};

/// Series of the three components of the gradient, without the point mass.
///
/// With V_nm = (R/r)^(n+1) P_nm e^(i m longitude), unnormalised (Cunningham 1970; Montenbruck and Gill 2000,
/// section 3.2.5):
///   R dV_nm/dz = -(n-m+1) V_(n+1,m),
///   R (d/dx + i d/dy) V_nm = -V_(n+1,m+1),   R (d/dx - i d/dy) V_nm = (n-m+1)(n-m+2) V_(n+1,m-1)  (m > 0),
/// and U = GM/R Re sum (C - i S) V. Here with the ratios of the normalisation factors.
Gradient gradient_series(const GravityCoefficients& field, int degree, int order) {
  Gradient gradient(degree + 1);
  for (int n = 2; n <= degree; ++n) {
    const double degree_ratio = (2.0 * n + 1.0) / (2.0 * n + 3.0);
    for (int m = 0; m <= std::min(n, order); ++m) {
      const double c = field.c_nm(n, m), s = field.s_nm(n, m);
      const double same = -std::sqrt(degree_ratio * (n + 1.0 - m) * (n + 1.0 + m));
      gradient.z.add(n + 1, m, same * c, same * s);

      const double up = -std::sqrt((m == 0 ? 0.5 : 1.0) * degree_ratio * (n + m + 1.0) * (n + m + 2.0));
      const double half_up = m == 0 ? up : 0.5 * up;  // V_n0 is real: both derivatives come from the one to m = 1
      gradient.x.add(n + 1, m + 1, half_up * c, half_up * s);
      gradient.y.add(n + 1, m + 1, -half_up * s, half_up * c);
      if (m > 0) {
        const double half_down = 0.5 * std::sqrt((m == 1 ? 2.0 : 1.0) * degree_ratio * (n - m + 1.0) * (n - m + 2.0));
        gradient.x.add(n + 1, m - 1, half_down * c, half_down * s);
        gradient.y.add(n + 1, m - 1, half_down * s, -half_down * c);
      }
    }
  }
  return gradient;
}

/// (n^2 - m^2) / (4 n^2 - 1): the recursion coefficient of Legendre functions with leading coefficient one.
double monic_recursion(int n, int m) {
  return (static_cast<double>(n) - m) * (static_cast<double>(n) + m) / (4.0 * n * n - 1.0);
}

}  // namespace

GravityField::GravityField(const GravityCoefficients& coefficients, int degree, int order, HarmonicSummation sum)
    : gm_(coefficients.gm), radius_(coefficients.radius), degree_(degree), order_(order), sum_(sum) {
  if (degree < 0 || degree > coefficients.degree) {
    throw std::invalid_argument(
        fmt::format("gravity degree {}; the coefficients have degrees 0 to {}", degree, coefficients.degree));
  }
  if (order < 0 || order > degree) {
    throw std::invalid_argument(
        fmt::format("gravity order {}; accepted are orders 0 to the degree, {}", order, degree));
  }
  if (degree < 2) return;

  const Gradient gradient = gradient_series(coefficients, degree, order);
  const int last_degree = degree + 1;
  const int last_order = order + 1;
  double sectoral = 1.0;  // normalised P_mm / cos^m(latitude)
  for (int block = 0; block <= last_order; block += 4) {
    const auto start = series_.terms.size();
    const int length = last_degree - block + 1;
    series_.lengths.push_back(length);
    series_.terms.resize(start + static_cast<std::size_t>(length), FourTerms{});
    for (int lane = 0; lane < 4; ++lane) {
      const int m = block + lane;
      if (m > 0) sectoral *= m == 1 ? std::sqrt(3.0) : std::sqrt((2.0 * m + 1.0) / (2.0 * m));
      if (m > last_order) continue;
      double factor = sectoral;  // normalised Legendre function over the one with leading coefficient one
      for (int n = m; n <= last_degree; ++n) {
        if (n > m) factor /= std::sqrt(monic_recursion(n, m));
        FourTerms& term = series_.terms[start + static_cast<std::size_t>(n - m)];
        term.recursion[lane] = n > m ? monic_recursion(n - 1, m) : 0.0;  // takes p_(k-1), p_(k-2) to p_k
        const auto i = GravityCoefficients::index(n, m);
        term.x_cos[lane] = factor * gradient.x.c[i];
        term.x_sin[lane] = factor * gradient.x.s[i];
        term.y_cos[lane] = factor * gradient.y.c[i];
        term.y_sin[lane] = factor * gradient.y.s[i];
        term.z_cos[lane] = factor * gradient.z.c[i];
        term.z_sin[lane] = factor * gradient.z.s[i];
      }
    }
  }
}

fsw::Vector3 GravityField::perturbation_itrf(const fsw::Vector3& position_itrf) const {
  const double r = position_itrf.norm();
  const double radius_per_r = radius_ / r;
  const double unit = radius_per_r / r;
  const HarmonicSum sum = sum_(series_, {position_itrf.x() * unit, position_itrf.y() * unit, position_itrf.z() * unit,
                                         radius_per_r * radius_per_r});
  return gm_ / (radius_ * radius_) * radius_per_r * fsw::Vector3(sum.x, sum.y, sum.z);
}

fsw::Vector3 GravityField::acceleration_itrf(const fsw::Vector3& position_itrf) const {
  const double r2 = position_itrf.squaredNorm();
  return perturbation_itrf(position_itrf) - gm_ / (r2 * std::sqrt(r2)) * position_itrf;
}

GravityForce::GravityForce(std::shared_ptr<const GravityField> field) : field_(std::move(field)) {
  if (!field_) throw std::invalid_argument("the gravity force needs a field");
}

fsw::Vector3 GravityForce::acceleration_eci(const ForceInput& input) {
  return input.R_itrf_gcrf.transpose() * field_->perturbation_itrf(input.position_itrf);
}

fsw::Vector3 third_body_acceleration(const fsw::Vector3& position, const fsw::Vector3& third_body, double gm) {
  // (distance to the third body / its distance from the origin)^2 = 1 + q, and f(q) = (1 + q)^(3/2) - 1.
  const double q = position.dot(position - 2.0 * third_body) / third_body.squaredNorm();
  const double ratio_cubed = (1.0 + q) * std::sqrt(1.0 + q);
  const double f = q * (3.0 + q * (3.0 + q)) / (1.0 + ratio_cubed);
  const double distance = (position - third_body).norm();
  return -gm / (distance * distance * distance) * (position + f * third_body);
}

fsw::Vector3 ThirdBodyForce::acceleration_eci(const ForceInput& input) {
  return body_ == Body::kSun ? third_body_acceleration(input.position_eci, input.sun_eci, kSunGm)
                             : third_body_acceleration(input.position_eci, input.moon_eci, kMoonGm);
}

namespace {

constexpr double kC2 = 299792458.0 * 299792458.0;  // speed of light, squared, m^2/s^2
constexpr double kEarthSpin = 9.8e8;  // the Earth's angular momentum per mass, m^2/s: IERS Conventions 2010, ch. 10

/// The Earth's orbital angular momentum per mass about the Sun, m^2/s, in GCRF: Kepler's sqrt(GM a (1 - e^2)) with a =
/// 1 au and e = 0.0167, along the pole of the ecliptic of J2000 (obliquity 84381.406", IAU 2006). It replaces the cross
/// product of distance and velocity, which the Moon perturbs by 4e-4.
fsw::Vector3 earth_orbital_angular_momentum() {
  constexpr double kEccentricity = 0.0167;
  constexpr double kObliquity = 84381.406 / 3600.0 * 3.14159265358979323846 / 180.0;
  return std::sqrt(kSunGm * kAstronomicalUnit * (1.0 - kEccentricity * kEccentricity)) *
         fsw::Vector3(0.0, -std::sin(kObliquity), std::cos(kObliquity));
}

}  // namespace

fsw::Vector3 schwarzschild_acceleration(double gm, const fsw::Vector3& position_eci, const fsw::Vector3& velocity_eci) {
  const double r = position_eci.norm();
  return gm / (kC2 * r * r * r) *
         ((4.0 * gm / r - velocity_eci.squaredNorm()) * position_eci +
          4.0 * position_eci.dot(velocity_eci) * velocity_eci);
}

fsw::Vector3 lense_thirring_acceleration(double gm, const fsw::Vector3& spin_axis_eci, const fsw::Vector3& position_eci,
                                         const fsw::Vector3& velocity_eci) {
  const double r = position_eci.norm();
  const fsw::Vector3 spin = kEarthSpin * spin_axis_eci;
  return 2.0 * gm / (kC2 * r * r * r) *
         (3.0 / (r * r) * position_eci.dot(spin) * position_eci.cross(velocity_eci) + velocity_eci.cross(spin));
}

fsw::Vector3 de_sitter_acceleration(double sun_distance, const fsw::Vector3& velocity_eci) {
  // The Conventions' V x (-GM R / (c^2 R^3)), R and V the Earth's position and velocity about the Sun, is
  // GM (R x V) / (c^2 R^3).
  static const fsw::Vector3 angular_momentum = earth_orbital_angular_momentum();
  const double factor = 3.0 * kSunGm / (kC2 * sun_distance * sun_distance * sun_distance);
  return factor * angular_momentum.cross(velocity_eci);
}

fsw::Vector3 RelativityForce::acceleration_eci(const ForceInput& input) {
  const fsw::Vector3 spin_axis_eci = input.R_itrf_gcrf.row(2).transpose();
  return schwarzschild_acceleration(gm_, input.position_eci, input.velocity_eci) +
         lense_thirring_acceleration(gm_, spin_axis_eci, input.position_eci, input.velocity_eci) +
         de_sitter_acceleration(input.sun_eci.norm(), input.velocity_eci);
}

}  // namespace vbar::truth
