#pragma once
// Cholesky factor of a small symmetric positive definite matrix, A = L L'. Eigen's own has a blocked branch for large
// matrices that leaves heap calls in the object code even of a 6x6; this one has none.

#include <Eigen/Core>

#include "fsw/core/types.h"
#include "fsw/math/math.h"

namespace vbar::fsw::math {

/// Factors A = L L'. Only the lower triangle of A is read.
template <int N>
class Cholesky {
 public:
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;

  explicit Cholesky(const Matrix& a) {
    for (int c = 0; c < N; ++c) {
      double pivot = a(c, c);
      for (int k = 0; k < c; ++k) pivot -= lower_(c, k) * lower_(c, k);
      if (!(pivot > 0.0) || !is_finite(pivot)) {
        smallest_pivot_ = 0.0;
        return;
      }
      if (c == 0 || pivot < smallest_pivot_) smallest_pivot_ = pivot;
      lower_(c, c) = sqrt(pivot);
      inverse_diagonal_(c) = 1.0 / lower_(c, c);
      for (int r = c + 1; r < N; ++r) {
        double sum = a(r, c);
        for (int k = 0; k < c; ++k) sum -= lower_(r, k) * lower_(c, k);
        lower_(r, c) = sum * inverse_diagonal_(c);
      }
    }
  }

  /// Returns false if A is not positive definite to rounding, or not finite; the solutions are then meaningless.
  [[nodiscard]] bool ok() const { return smallest_pivot_ > 0.0; }

  /// Smallest squared diagonal element of L, 0 unless ok(): it measures the linear dependence of the worst row of A on
  /// the rows before it.
  [[nodiscard]] double smallest_pivot() const { return smallest_pivot_; }

  /// Returns L^-1 b.
  [[nodiscard]] Vector solve_lower(Vector b) const {
    for (int r = 0; r < N; ++r) {
      for (int k = 0; k < r; ++k) b(r) -= lower_(r, k) * b(k);
      b(r) *= inverse_diagonal_(r);
    }
    return b;
  }

  /// Returns A^-1 b.
  [[nodiscard]] Vector solve(const Vector& b) const {
    Vector x = solve_lower(b);
    for (int r = N - 1; r >= 0; --r) {
      for (int k = r + 1; k < N; ++k) x(r) -= lower_(k, r) * x(k);
      x(r) *= inverse_diagonal_(r);
    }
    return x;
  }

  /// Returns A^-1.
  [[nodiscard]] Matrix inverse() const {
    Matrix result;
    for (int c = 0; c < N; ++c) result.col(c) = solve(Vector::Unit(c));
    return result;
  }

 private:
  Matrix lower_ = Matrix::Zero();
  Vector inverse_diagonal_ = Vector::Zero();
  double smallest_pivot_ = 0.0;
};

using Cholesky6 = Cholesky<6>;

}  // namespace vbar::fsw::math
