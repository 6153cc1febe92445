#include "fsw/orbit/gravity_field.h"

#include "fsw/math/math.h"
#include "fsw/orbit/gravity_coefficients.h"

namespace vbar::fsw::orbit {
namespace {

constexpr int kLast = kGravityDegree + 1;  // degree and order of the gradient's series

/// Newton's method, for values near one: compile-time results must not depend on the library of the compiler.
constexpr double square_root(double x) {
  double root = x > 1.0 ? x : 1.0;
  for (int k = 0; k < 40; ++k) {
    const double next = 0.5 * (root + x / root);
    if (next >= root && k > 0) break;
    root = next;
  }
  return root;
}

/// Weights of a harmonic of the gradient in the three components, and c of the recursion p_k = z p_(k-1) - q c
/// p_(k-2). Weights that are summed alike lie side by side.
struct Term {
  double recursion = 0.0;
  double x_cos = 0.0, y_cos = 0.0, z_cos = 0.0;
  double x_sin = 0.0, y_sin = 0.0, z_sin = 0.0;
};

/// By order, and in it by degree.
using Series = std::array<Term, stokes_index(kLast + 1, 0)>;

constexpr std::size_t term_index(int n, int m) {
  return static_cast<std::size_t>(m * (kLast + 1) - m * (m - 1) / 2 + n - m);
}

/// (n^2 - m^2) / (4 n^2 - 1): the recursion coefficient of Legendre functions with leading coefficient one.
constexpr double monic_recursion(int n, int m) {
  return static_cast<double>((n - m) * (n + m)) / static_cast<double>(4 * n * n - 1);
}

/// The gradient, fully normalised, in units of GM/R^2 (Montenbruck and Gill 2000, section 3.2.5, with the ratios of
/// the normalisation factors).
constexpr void add_gradient(Series& series) {
  for (int n = 2; n <= kGravityDegree; ++n) {
    const double degree_ratio = (2.0 * n + 1.0) / (2.0 * n + 3.0);
    for (int m = 0; m <= n; ++m) {
      const auto [c, s] = kStokesCoefficients[stokes_index(n, m)];
      const double same = -square_root(degree_ratio * ((n + 1.0 - m) * (n + 1.0 + m)));
      Term& level = series[term_index(n + 1, m)];
      level.z_cos += same * c;
      level.z_sin += same * s;
      const double up = -square_root((m == 0 ? 0.5 : 1.0) * degree_ratio * ((n + m + 1.0) * (n + m + 2.0)));
      const double half_up = m == 0 ? up : 0.5 * up;  // V_n0 is real: both derivatives come from the one to m = 1
      Term& above = series[term_index(n + 1, m + 1)];
      above.x_cos += half_up * c;
      above.x_sin += half_up * s;
      above.y_cos -= half_up * s;
      above.y_sin += half_up * c;
      if (m == 0) continue;
      const double half_down = 0.5 * square_root((m == 1 ? 2.0 : 1.0) * degree_ratio * ((n - m + 1.0) * (n - m + 2.0)));
      Term& below = series[term_index(n + 1, m - 1)];
      below.x_cos += half_down * c;
      below.x_sin += half_down * s;
      below.y_cos += half_down * s;
      below.y_sin -= half_down * c;
    }
  }
}

/// Takes the factors of the normalised Legendre functions over those with leading coefficient one into the weights.
constexpr void scale_to_monic(Series& series) {
  double sectoral = 1.0;
  for (int m = 0; m <= kLast; ++m) {
    if (m > 0) sectoral *= m == 1 ? square_root(3.0) : square_root((2.0 * m + 1.0) / (2.0 * m));
    double factor = sectoral;
    for (int n = m; n <= kLast; ++n) {
      if (n > m) factor /= square_root(monic_recursion(n, m));
      Term& term = series[term_index(n, m)];
      term.recursion = n > m + 1 ? monic_recursion(n - 1, m) : 0.0;
      term.x_cos *= factor;
      term.x_sin *= factor;
      term.y_cos *= factor;
      term.y_sin *= factor;
      term.z_cos *= factor;
      term.z_sin *= factor;
    }
  }
}

constexpr Series make_series() {
  Series series{};
  add_gradient(series);
  scale_to_monic(series);
  return series;
}

constexpr Series kSeries = make_series();

/// Two sums side by side, which a processor with registers for both adds in one operation; each has the bits that it
/// has alone.
using Pair [[gnu::vector_size(2 * sizeof(double))]] = double;

/// The sums of an order: [x_cos, y_cos], [z_cos, x_sin], [y_sin, z_sin].
struct Sums {
  Pair xy_cos{}, z_cos_x_sin{}, yz_sin{};

  void add(double p, const Term& term) {
    const Pair factor{p, p};
    xy_cos += factor * Pair{term.x_cos, term.y_cos};
    z_cos_x_sin += factor * Pair{term.z_cos, term.x_sin};
    yz_sin += factor * Pair{term.y_sin, term.z_sin};
  }
  [[nodiscard]] Vector3 of_cos() const { return {xy_cos[0], xy_cos[1], z_cos_x_sin[0]}; }
  [[nodiscard]] Vector3 of_sin() const { return {z_cos_x_sin[1], yz_sin[0], yz_sin[1]}; }
};

}  // namespace

Vector3 gravity_itrf(const Vector3& position_itrf) {
  const double r2 = position_itrf.squaredNorm();
  const double r = math::sqrt(r2);
  const double radius_per_r = kEarthRadius / r;
  const Vector3 unit = position_itrf * (radius_per_r / r);
  const double q = radius_per_r * radius_per_r;
  Vector3 sum = Vector3::Zero();
  double cos_m = 1.0;  // ((R/r) cos(latitude))^m times cos and sin of m longitude
  double sin_m = 0.0;
  const Term* term = kSeries.data();
  for (int m = 0; m <= kLast; ++m) {
    Sums sums;
    double p = 1.0;
    double before = 0.0;
    for (int n = m; n <= kLast; ++n, ++term) {
      if (n > m) {
        const double next = unit.z() * p - q * term->recursion * before;
        before = p;
        p = next;
      }
      sums.add(p, *term);
    }
    sum += cos_m * sums.of_cos() + sin_m * sums.of_sin();
    const double next_cos = cos_m * unit.x() - sin_m * unit.y();
    sin_m = cos_m * unit.y() + sin_m * unit.x();
    cos_m = next_cos;
  }
  return kMu / (kEarthRadius * kEarthRadius) * radius_per_r * sum - kMu / (r2 * r) * position_itrf;
}

}  // namespace vbar::fsw::orbit
