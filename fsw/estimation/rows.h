#pragma once
// Measurements as rows: sensitivity, residual and noise, and the one way in which they update an estimate.
//
// Rows are formed about the mean of the estimate (a regression by sigma points where the model is nonlinear, its
// nonlinearity added to the noise). Groups of rows (the two of a keypoint, the one of a satellite) beyond their gate
// are excluded; the others are decorrelated by the Cholesky factor of their noise and processed one after the other.

#include <array>

#include <Eigen/Core>

#include "fsw/estimation/estimate.h"
#include "fsw/math/math.h"

namespace vbar::fsw::estimation {

/// No limit of a normalised innovation squared.
inline constexpr double kNoGate = 1e300;

/// Up to kMax scalar measurements of one instant, of a state of N components. Large: not for the stack.
template <int N, int kMax>
class Rows {
 public:
  using Row = Eigen::Matrix<double, N, 1>;
  using Vector = Eigen::Matrix<double, kMax, 1>;
  using Square = Eigen::Matrix<double, kMax, kMax>;

  /// `count` rows of zeros, all in use.
  void clear(int count) {
    count_ = count;
    sensitivity.leftCols(count).setZero();
    residual.setZero();
    noise.setZero();
    innovation.setZero();
    is_used.fill(true);
  }

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] int used() const {
    int sum = 0;
    for (int k = 0; k < count_; ++k) sum += is_used[at(k)] ? 1 : 0;
    return sum;
  }

  Eigen::Matrix<double, N, kMax> sensitivity;  ///< column k: derivative of measurement k with respect to the state
  Vector residual;                             ///< measured minus predicted
  Square noise;                                ///< covariance, m x m of the unit of the measurements
  Square innovation;                           ///< covariance H P H' + noise, by predict_innovations()
  std::array<bool, static_cast<std::size_t>(kMax)> is_used{};

  [[nodiscard]] static constexpr std::size_t at(int k) { return static_cast<std::size_t>(k); }

 private:
  int count_ = 0;
};

/// Fills `rows.innovation`.
template <int N, int kMax>
void predict_innovations(const Estimate<N>& estimate, Rows<N, kMax>& rows) {
  rows.innovation.topLeftCorner(rows.count(), rows.count()) = rows.noise.topLeftCorner(rows.count(), rows.count());
  for (int c = 0; c < rows.count(); ++c) {
    if (!rows.is_used[rows.at(c)]) continue;
    const typename Rows<N, kMax>::Row ph = estimate.covariance_times(rows.sensitivity.col(c));
    for (int r = 0; r <= c; ++r) {
      const double covariance = rows.sensitivity.col(r).dot(ph);
      rows.innovation(r, c) += covariance;
      if (r != c) rows.innovation(c, r) += covariance;
    }
  }
}

/// Lower Cholesky factor of the rows and columns in use of `matrix`, compacted; false if not positive definite.
template <int N, int kMax>
bool factorise_used(const Rows<N, kMax>& rows, const typename Rows<N, kMax>::Square& matrix,
                    typename Rows<N, kMax>::Square& lower) {
  int c = 0;
  for (int column = 0; column < rows.count(); ++column) {
    if (!rows.is_used[rows.at(column)]) continue;
    double pivot = matrix(column, column);
    for (int k = 0; k < c; ++k) pivot -= lower(c, k) * lower(c, k);
    if (!(pivot > 0.0) || !math::is_finite(pivot)) return false;
    lower(c, c) = math::sqrt(pivot);
    int r = c + 1;
    for (int row = column + 1; row < rows.count(); ++row) {
      if (!rows.is_used[rows.at(row)]) continue;
      double sum = matrix(row, column);
      for (int k = 0; k < c; ++k) sum -= lower(r, k) * lower(c, k);
      lower(r, c) = sum / lower(c, c);
      ++r;
    }
    ++c;
  }
  return true;
}

/// Normalised innovation squared of the rows in use together; kNoGate if their covariance is not positive definite.
template <int N, int kMax>
[[nodiscard]] double joint_nis(const Rows<N, kMax>& rows) {
  typename Rows<N, kMax>::Square lower;
  if (!factorise_used(rows, rows.innovation, lower)) return kNoGate;
  typename Rows<N, kMax>::Vector whitened;
  double sum = 0.0;
  int r = 0;
  for (int row = 0; row < rows.count(); ++row) {
    if (!rows.is_used[rows.at(row)]) continue;
    double value = rows.residual(row);
    for (int k = 0; k < r; ++k) value -= lower(r, k) * whitened(k);
    whitened(r) = value / lower(r, r);
    sum += whitened(r) * whitened(r);
    ++r;
  }
  return sum;
}

/// The same of one group: rows `first` to `first + size`, size 1 or 2.
template <int N, int kMax>
[[nodiscard]] double group_nis(const Rows<N, kMax>& rows, int first, int size) {
  const double a = rows.innovation(first, first);
  const double ra = rows.residual(first);
  if (size == 1) return a > 0.0 ? ra * ra / a : kNoGate;
  const double b = rows.innovation(first, first + 1);
  const double c = rows.innovation(first + 1, first + 1);
  const double rb = rows.residual(first + 1);
  const double determinant = a * c - b * b;
  if (!(determinant > 0.0)) return kNoGate;
  return (c * ra * ra - 2.0 * b * ra * rb + a * rb * rb) / determinant;
}

/// Updates the estimate by the rows in use; `residual` then holds the residuals after the update, of all rows. The
/// sensitivities are overwritten. False, with nothing changed, if the noise is not positive definite.
template <int N, int kMax>
bool fold_in(Estimate<N>& estimate, Rows<N, kMax>& rows) {
  typename Rows<N, kMax>::Square lower;
  if (!factorise_used(rows, rows.noise, lower)) return false;
  const typename Estimate<N>::Vector old = estimate.mean();
  typename Rows<N, kMax>::Vector value;
  int r = 0;
  for (int row = 0; row < rows.count(); ++row) {
    if (!rows.is_used[rows.at(row)]) continue;
    // Row r of L^-1 H and of L^-1 times the residual; the columns of rows before are whitened already, in place.
    double whitened = rows.residual(row);
    int k = 0;
    for (int before = 0; before < row; ++before) {
      if (!rows.is_used[rows.at(before)]) continue;
      rows.sensitivity.col(row) -= lower(r, k) * rows.sensitivity.col(before);
      whitened -= lower(r, k) * value(k);
      ++k;
    }
    rows.sensitivity.col(row) /= lower(r, r);
    value(r) = whitened / lower(r, r);
    const auto h = rows.sensitivity.col(row);
    estimate.update(h, value(r) - h.dot(estimate.mean() - old), 1.0, kNoGate);
    ++r;
  }
  const typename Estimate<N>::Vector change = estimate.mean() - old;
  r = 0;
  for (int row = 0; row < rows.count(); ++row) {
    const double by_change = rows.sensitivity.col(row).dot(change);
    if (!rows.is_used[rows.at(row)]) {
      rows.residual(row) -= by_change;
      continue;
    }
    value(r) -= by_change;
    rows.residual(row) = lower.row(r).head(r + 1).dot(value.head(r + 1));
    ++r;
  }
  return true;
}

}  // namespace vbar::fsw::estimation
