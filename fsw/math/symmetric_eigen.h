#pragma once
// Eigenvalues and eigenvectors of small symmetric matrices by Jacobi rotations (Golub & Van Loan, Matrix
// Computations, 8.5). Eigen's solver for a general size leaves heap calls in the object code; this one does not; its
// loops have fixed bounds.

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/math/math.h"

namespace vbar::fsw::math {

/// A = vectors * diag(values) * vectors', values increasing, columns orthonormal.
template <int N>
struct SymmetricEigen {
  Eigen::Matrix<double, N, 1> values = Eigen::Matrix<double, N, 1>::Zero();
  Eigen::Matrix<double, N, N> vectors = Eigen::Matrix<double, N, N>::Identity();
};

/// Rotates columns and rows p < q of the upper triangle `a` so that a(p, q) vanishes, and the columns of `v` with them.
template <int N>
void jacobi_rotation(Eigen::Matrix<double, N, N>& a, Eigen::Matrix<double, N, N>& v, int p, int q) {
  if (a(p, q) == 0.0) return;
  // The smaller of the two angles that annihilate a(p, q).
  const double cotangent = (a(q, q) - a(p, p)) / (2.0 * a(p, q));
  const double root = sqrt(1.0 + cotangent * cotangent);
  const double t = cotangent >= 0.0 ? 1.0 / (cotangent + root) : 1.0 / (cotangent - root);
  const double c = 1.0 / sqrt(1.0 + t * t);
  const double s = t * c;
  const auto rotate = [c, s](double& x, double& y) {
    const double old = x;
    x = c * old - s * y;
    y = s * old + c * y;
  };
  a(p, p) -= t * a(p, q);
  a(q, q) += t * a(p, q);
  a(p, q) = 0.0;
  for (int k = 0; k < N; ++k) {
    if (k != p && k != q) rotate(k < p ? a(k, p) : a(p, k), k < q ? a(k, q) : a(q, k));
    rotate(v(k, p), v(k, q));
  }
}

/// Exchanges pairs until the values increase.
template <int N>
void sort_by_value(SymmetricEigen<N>& e) {
  for (int p = 0; p < N; ++p) {
    for (int q = p + 1; q < N; ++q) {
      if (e.values(q) >= e.values(p)) continue;
      const double value = e.values(p);
      e.values(p) = e.values(q);
      e.values(q) = value;
      const Eigen::Matrix<double, N, 1> vector = e.vectors.col(p);
      e.vectors.col(p) = e.vectors.col(q);
      e.vectors.col(q) = vector;
    }
  }
}

/// Diagonalises the symmetric `a`, of which only the upper triangle is read, to rounding. kNotFinite; kDidNotConverge
/// after 16 sweeps (quadratic convergence takes 3 to 6 for N <= 6).
template <int N>
Result<SymmetricEigen<N>> symmetric_eigen(Eigen::Matrix<double, N, N> a) {
  constexpr int kMaxSweeps = 16;
  constexpr double kNegligible = 1e-32;  // squared, of off-diagonal over diagonal elements
  SymmetricEigen<N> result;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double diagonal = 0.0;
    double rest = 0.0;
    for (int p = 0; p < N; ++p) {
      diagonal += a(p, p) * a(p, p);
      for (int q = p + 1; q < N; ++q) rest += a(p, q) * a(p, q);
    }
    if (!is_finite(diagonal + rest)) return Status::kNotFinite;
    if (rest <= kNegligible * diagonal) {
      result.values = a.diagonal();
      sort_by_value(result);
      return result;
    }
    for (int p = 0; p < N; ++p) {
      for (int q = p + 1; q < N; ++q) jacobi_rotation<N>(a, result.vectors, p, q);
    }
  }
  return Status::kDidNotConverge;
}

}  // namespace vbar::fsw::math
