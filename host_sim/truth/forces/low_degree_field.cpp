#include "host_sim/truth/forces/low_degree_field.h"

#include <array>
#include <cmath>

namespace vbar::truth {
namespace {

constexpr int kTop = LowDegreeCoefficients::kDegree + 1;  // the gradient reaches one degree higher

/// Unnormalised solid harmonics V_nm + i W_nm = (R/r)^(n+1) P_nm(sin latitude) e^(i m longitude).
struct SolidHarmonics {
  double v[kTop + 1][kTop + 1] = {};
  double w[kTop + 1][kTop + 1] = {};
};

/// Recursions of Cunningham 1970; Montenbruck and Gill 2000, eq. 3.29 to 3.31.
SolidHarmonics solid_harmonics(double radius, const fsw::Vector3& position) {
  const double r2 = position.squaredNorm();
  const double q = radius * radius / r2;
  const fsw::Vector3 p = radius / r2 * position;
  SolidHarmonics h;
  h.v[0][0] = std::sqrt(q);
  for (int m = 0; m <= kTop; ++m) {
    if (m > 0) {
      h.v[m][m] = (2 * m - 1) * (p.x() * h.v[m - 1][m - 1] - p.y() * h.w[m - 1][m - 1]);
      h.w[m][m] = (2 * m - 1) * (p.x() * h.w[m - 1][m - 1] + p.y() * h.v[m - 1][m - 1]);
    }
    for (int n = m + 1; n <= kTop; ++n) {
      const double before_last_v = n > m + 1 ? h.v[n - 2][m] : 0.0;
      const double before_last_w = n > m + 1 ? h.w[n - 2][m] : 0.0;
      h.v[n][m] = ((2 * n - 1) * p.z() * h.v[n - 1][m] - (n + m - 1) * q * before_last_v) / (n - m);
      h.w[n][m] = ((2 * n - 1) * p.z() * h.w[n - 1][m] - (n + m - 1) * q * before_last_w) / (n - m);
    }
  }
  return h;
}

/// sqrt((2 - delta_0m) (2n + 1) (n - m)! / (n + m)!): normalised over unnormalised Legendre function.
using Normalisation =
    std::array<std::array<double, LowDegreeCoefficients::kDegree + 1>, LowDegreeCoefficients::kDegree + 1>;

Normalisation make_normalisation() {
  Normalisation factor{};
  for (int n = 0; n <= LowDegreeCoefficients::kDegree; ++n) {
    double square = 2.0 * n + 1.0;
    for (int m = 0; m <= n; ++m) {
      if (m == 1) square *= 2.0;
      if (m > 0) square /= static_cast<double>(n + m) * (n - m + 1);
      factor[static_cast<std::size_t>(n)][static_cast<std::size_t>(m)] = std::sqrt(square);
    }
  }
  return factor;
}

}  // namespace

fsw::Vector3 acceleration_itrf(const LowDegreeCoefficients& coefficients, double gm, double radius,
                               const fsw::Vector3& position_itrf) {
  static const Normalisation normalisation = make_normalisation();
  const SolidHarmonics h = solid_harmonics(radius, position_itrf);
  fsw::Vector3 sum = fsw::Vector3::Zero();
  for (int n = 2; n <= LowDegreeCoefficients::kDegree; ++n) {
    for (int m = 0; m <= n; ++m) {
      const double factor = normalisation[static_cast<std::size_t>(n)][static_cast<std::size_t>(m)];
      const double c = factor * coefficients.c[n][m], s = factor * coefficients.s[n][m];
      // Montenbruck and Gill 2000, eq. 3.33.
      if (m == 0) {
        sum.x() -= c * h.v[n + 1][1];
        sum.y() -= c * h.w[n + 1][1];
      } else {
        const double down = (n - m + 1.0) * (n - m + 2.0);
        sum.x() += 0.5 * (-c * h.v[n + 1][m + 1] - s * h.w[n + 1][m + 1] +
                          down * (c * h.v[n + 1][m - 1] + s * h.w[n + 1][m - 1]));
        sum.y() += 0.5 * (-c * h.w[n + 1][m + 1] + s * h.v[n + 1][m + 1] +
                          down * (-c * h.w[n + 1][m - 1] + s * h.v[n + 1][m - 1]));
      }
      sum.z() += (n - m + 1) * (-c * h.v[n + 1][m] - s * h.w[n + 1][m]);
    }
  }
  return gm / (radius * radius) * sum;
}

}  // namespace vbar::truth
