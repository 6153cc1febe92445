#pragma once
// A Gaussian estimate and the elementary operations of a filter: reset a component, add process noise, process a scalar
// measurement. All operations work in place: with 80 components a second covariance would exceed the stack on board.
//
// Components may be inactive (an ambiguity of a satellite not in view): their variance is zero; no operation changes
// them.
//
// Products are Eigen's lazy ones: its blocked kernels for larger matrices leave heap calls in the object code.

#include <Eigen/Core>

#include "fsw/core/result.h"
#include "fsw/math/math.h"

namespace vbar::fsw::estimation {

/// Result of a scalar measurement.
struct Innovation {
  double value = 0.0;     ///< measured minus predicted
  double variance = 0.0;  ///< predicted, of the estimate and the noise together
  bool accepted = false;

  /// Normalised innovation squared: chi-square with one degree of freedom if the filter is consistent.
  [[nodiscard]] double nis() const { return value * value / variance; }
};

template <int N>
class Estimate {
 public:
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;

  [[nodiscard]] const Vector& mean() const { return mean_; }
  [[nodiscard]] double mean(int i) const { return mean_(i); }
  [[nodiscard]] double variance(int i) const { return covariance_(i, i); }
  [[nodiscard]] double covariance(int i, int j) const { return covariance_(i, j); }
  /// Of the first M components.
  template <int M>
  [[nodiscard]] Eigen::Matrix<double, M, M> head_covariance() const {
    return covariance_.template topLeftCorner<M, M>();
  }
  [[nodiscard]] bool is_idle(int i) const { return covariance_(i, i) == 0.0; }

  /// Component i is `mean` with `variance`, independent of all others; variance 0 deactivates it.
  void reset(int i, double mean, double variance) {
    mean_(i) = mean;
    covariance_.row(i).setZero();
    covariance_.col(i).setZero();
    covariance_(i, i) = variance;
  }

  /// Shifts the mean: a known change, such as a maneuver.
  void shift(int i, double by) { mean_(i) += by; }

  /// Component i is multiplied by `factor`, as in a Gauss-Markov decay.
  void scale(int i, double factor) {
    mean_(i) *= factor;
    covariance_.row(i) *= factor;
    covariance_.col(i) *= factor;
  }

  /// Independent noise on component i.
  void add_noise(int i, double variance) { covariance_(i, i) += variance; }

  /// The first M components are propagated by x <- mean + A (x - old mean) plus independent noise of covariance Q.
  template <int M>
  void transform_head(const Eigen::Matrix<double, M, 1>& mean, const Eigen::Matrix<double, M, M>& a,
                      const Eigen::Matrix<double, M, M>& q) {
    mean_.template head<M>() = mean;
    for (int c = 0; c < N; ++c) {
      const Eigen::Matrix<double, M, 1> column = covariance_.col(c).template head<M>();
      covariance_.col(c).template head<M>() = a.lazyProduct(column);
    }
    for (int r = 0; r < N; ++r) {
      const Eigen::Matrix<double, M, 1> row = covariance_.row(r).template head<M>().transpose();
      covariance_.row(r).template head<M>() = a.lazyProduct(row).transpose();
    }
    covariance_.template topLeftCorner<M, M>() += q;
    symmetrise();
  }

  /// Innovation of a measurement with the linear(ised) model z = h x + noise, without updating the estimate.
  /// `residual`: measured minus predicted.
  [[nodiscard]] Innovation predict(const Vector& h, double residual, double noise_variance) const {
    return {.value = residual, .variance = h.dot(covariance_times(h)) + noise_variance, .accepted = false};
  }

  /// Updates the estimate unless nis() exceeds `gate` or a value is not finite.
  Innovation update(const Vector& h, double residual, double noise_variance, double gate) {
    const Vector ph = covariance_times(h);
    Innovation innovation{.value = residual, .variance = h.dot(ph) + noise_variance, .accepted = false};
    // Written such that a NaN is refused.
    if (!(innovation.variance > 0.0) || !(innovation.nis() <= gate)) return innovation;
    innovation.accepted = true;
    mean_ += ph * (residual / innovation.variance);
    for (int c = 0; c < N; ++c) {
      if (ph(c) == 0.0) continue;
      const double gain = ph(c) / innovation.variance;
      for (int r = c; r < N; ++r) {
        const double less = covariance_(r, c) - ph(r) * gain;
        covariance_(r, c) = less;
        covariance_(c, r) = less;
      }
    }
    return innovation;
  }

  /// Whether every value is finite and no variance negative; otherwise the filter must be restarted.
  [[nodiscard]] bool is_sound() const {
    double sum = 0.0;
    double minimum = 0.0;
    for (int i = 0; i < N; ++i) {
      sum += mean_(i) + covariance_.col(i).sum();
      minimum = covariance_(i, i) < minimum ? covariance_(i, i) : minimum;
    }
    return math::is_finite(sum) && minimum >= 0.0;
  }

 private:
  /// P h. A measurement depends on few of the components; the columns of the others are skipped.
  [[nodiscard]] Vector covariance_times(const Vector& h) const {
    Vector product = Vector::Zero();
    for (int c = 0; c < N; ++c) {
      if (h(c) != 0.0) product += h(c) * covariance_.col(c);
    }
    return product;
  }

  void symmetrise() {
    for (int c = 0; c < N; ++c) {
      for (int r = 0; r < c; ++r) {
        const double both = 0.5 * (covariance_(r, c) + covariance_(c, r));
        covariance_(r, c) = both;
        covariance_(c, r) = both;
      }
    }
  }

  Vector mean_ = Vector::Zero();
  Matrix covariance_ = Matrix::Zero();
};

}  // namespace vbar::fsw::estimation
