#pragma once
// A batch of measurements as rows - sensitivity H, residual z and noise R - and the one way in which it updates an
// estimate: x <- x + P H' (H P H' + R)^-1 z.
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
class MeasurementBatch {
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

/// Fills `batch.innovation`.
template <int N, int kMax>
void predict_innovations(const Estimate<N>& estimate, MeasurementBatch<N, kMax>& batch) {
  batch.innovation.topLeftCorner(batch.count(), batch.count()) =
      batch.noise.topLeftCorner(batch.count(), batch.count());
  for (int c = 0; c < batch.count(); ++c) {
    if (!batch.is_used[batch.at(c)]) continue;
    const typename MeasurementBatch<N, kMax>::Row ph = estimate.covariance_times(batch.sensitivity.col(c));
    for (int r = 0; r <= c; ++r) {
      const double covariance = batch.sensitivity.col(r).dot(ph);
      batch.innovation(r, c) += covariance;
      if (r != c) batch.innovation(c, r) += covariance;
    }
  }
}

/// Lower Cholesky factor of the rows and columns in use of `matrix`, compacted; false if not positive definite.
template <int N, int kMax>
bool factorise_used(const MeasurementBatch<N, kMax>& batch, const typename MeasurementBatch<N, kMax>::Square& matrix,
                    typename MeasurementBatch<N, kMax>::Square& lower) {
  int c = 0;
  for (int column = 0; column < batch.count(); ++column) {
    if (!batch.is_used[batch.at(column)]) continue;
    double pivot = matrix(column, column);
    for (int k = 0; k < c; ++k) pivot -= lower(c, k) * lower(c, k);
    if (!(pivot > 0.0) || !math::is_finite(pivot)) return false;
    lower(c, c) = math::sqrt(pivot);
    int r = c + 1;
    for (int row = column + 1; row < batch.count(); ++row) {
      if (!batch.is_used[batch.at(row)]) continue;
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
[[nodiscard]] double joint_nis(const MeasurementBatch<N, kMax>& batch) {
  typename MeasurementBatch<N, kMax>::Square lower;
  if (!factorise_used(batch, batch.innovation, lower)) return kNoGate;
  typename MeasurementBatch<N, kMax>::Vector whitened;
  double sum = 0.0;
  int r = 0;
  for (int row = 0; row < batch.count(); ++row) {
    if (!batch.is_used[batch.at(row)]) continue;
    double value = batch.residual(row);
    for (int k = 0; k < r; ++k) value -= lower(r, k) * whitened(k);
    whitened(r) = value / lower(r, r);
    sum += whitened(r) * whitened(r);
    ++r;
  }
  return sum;
}

/// Normalised innovation squared of one group: rows `first` to `first + size`, size 1 or 2.
template <int N, int kMax>
[[nodiscard]] double group_nis(const MeasurementBatch<N, kMax>& batch, int first, int size) {
  const double a = batch.innovation(first, first);
  const double ra = batch.residual(first);
  if (size == 1) return a > 0.0 ? ra * ra / a : kNoGate;
  const double b = batch.innovation(first, first + 1);
  const double c = batch.innovation(first + 1, first + 1);
  const double rb = batch.residual(first + 1);
  const double determinant = a * c - b * b;
  if (!(determinant > 0.0)) return kNoGate;
  return (c * ra * ra - 2.0 * b * ra * rb + a * rb * rb) / determinant;
}

/// Updates the estimate by the rows in use; `residual` then holds the residuals after the update, of all rows. The
/// sensitivities are overwritten. False, with nothing changed, if the noise is not positive definite.
template <int N, int kMax>
bool update(Estimate<N>& estimate, MeasurementBatch<N, kMax>& batch) {
  typename MeasurementBatch<N, kMax>::Square lower;
  if (!factorise_used(batch, batch.noise, lower)) return false;
  const typename Estimate<N>::Vector old = estimate.mean();
  typename MeasurementBatch<N, kMax>::Vector value;
  int r = 0;
  for (int row = 0; row < batch.count(); ++row) {
    if (!batch.is_used[batch.at(row)]) continue;
    // Row r of L^-1 H and of L^-1 times the residual; the columns of rows before are whitened already, in place.
    double whitened = batch.residual(row);
    int k = 0;
    for (int before = 0; before < row; ++before) {
      if (!batch.is_used[batch.at(before)]) continue;
      batch.sensitivity.col(row) -= lower(r, k) * batch.sensitivity.col(before);
      whitened -= lower(r, k) * value(k);
      ++k;
    }
    batch.sensitivity.col(row) /= lower(r, r);
    value(r) = whitened / lower(r, r);
    const auto h = batch.sensitivity.col(row);
    estimate.update(h, value(r) - h.dot(estimate.mean() - old), 1.0, kNoGate);
    ++r;
  }
  const typename Estimate<N>::Vector change = estimate.mean() - old;
  r = 0;
  for (int row = 0; row < batch.count(); ++row) {
    const double by_change = batch.sensitivity.col(row).dot(change);
    if (!batch.is_used[batch.at(row)]) {
      batch.residual(row) -= by_change;
      continue;
    }
    value(r) -= by_change;
    batch.residual(row) = lower.row(r).head(r + 1).dot(value.head(r + 1));
    ++r;
  }
  return true;
}

}  // namespace vbar::fsw::estimation
