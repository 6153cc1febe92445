#pragma once
// A Gaussian estimate and the elementary operations of a filter: reset a component, add process noise, process a scalar
// measurement. All operations work in place: with 80 components a second covariance would exceed the stack on board.
//
// Components may be inactive (an ambiguity of a satellite not in view): their variance is zero; no operation changes
// them. Those behind the last active one cost no time.
//
// Products are Eigen's lazy ones: its blocked kernels for larger matrices leave heap calls in the object code.

#include <array>
#include <cstddef>
#include <cstdint>

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
  [[nodiscard]] double variance(int i) const { return matrix()(i, i); }
  [[nodiscard]] double covariance(int i, int j) const { return matrix()(i, j); }
  /// Covariance of the first M components.
  template <int M>
  [[nodiscard]] Eigen::Matrix<double, M, M> head_covariance() const {
    return matrix().template topLeftCorner<M, M>();
  }
  [[nodiscard]] bool is_inactive(int i) const { return matrix()(i, i) == 0.0; }

  /// Component i is `mean` with `variance`, independent of all others; variance 0 deactivates it.
  void reset(int i, double mean, double variance) {
    mean_(i) = mean;
    matrix().row(i).head(extent_).setZero();
    matrix().col(i).head(extent_).setZero();
    matrix()(i, i) = variance;
    if (variance != 0.0) extend_to(i);
    while (extent_ > 0 && is_inactive(extent_ - 1)) --extent_;
  }

  /// Sets the covariance of two active components, as known from a batch solution.
  void correlate(int i, int j, double covariance) {
    matrix()(i, j) = covariance;
    matrix()(j, i) = covariance;
  }

  /// Shifts the mean: a known change, such as a maneuver.
  void shift(int i, double by) { mean_(i) += by; }

  /// Component i is multiplied by `factor`, as in a Gauss-Markov decay.
  void scale(int i, double factor) {
    mean_(i) *= factor;
    matrix().row(i).head(extent_) *= factor;
    matrix().col(i).head(extent_) *= factor;
  }

  /// Independent noise on component i.
  void add_noise(int i, double variance) {
    matrix()(i, i) += variance;
    extend_to(i);
  }

  /// The first M components are propagated by x <- mean + A (x - old mean) plus independent noise of covariance Q.
  template <int M>
  void transform_head(const Eigen::Matrix<double, M, 1>& mean, const Eigen::Matrix<double, M, M>& a,
                      const Eigen::Matrix<double, M, M>& q) {
    mean_.template head<M>() = mean;
    extend_to(M - 1);
    for (int c = 0; c < extent_; ++c) {
      if (c >= M && is_inactive(c)) continue;
      const Eigen::Matrix<double, M, 1> column = matrix().col(c).template head<M>();
      matrix().col(c).template head<M>() = a.lazyProduct(column);
    }
    for (int r = 0; r < extent_; ++r) {
      if (r >= M && is_inactive(r)) continue;
      const Eigen::Matrix<double, M, 1> row = matrix().row(r).template head<M>().transpose();
      matrix().row(r).template head<M>() = a.lazyProduct(row).transpose();
    }
    matrix().template topLeftCorner<M, M>() += q;
    symmetrise_head(M);
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
    // Written such that a NaN is rejected.
    if (!(innovation.variance > 0.0) || !(innovation.nis() <= gate)) return innovation;
    innovation.accepted = true;
    mean_.head(extent_) += ph.head(extent_) * (residual / innovation.variance);
    reduce(ph, innovation.variance);
    return innovation;
  }

  /// P h. A measurement depends on few of the components; the columns of the others are skipped.
  [[nodiscard]] Vector covariance_times(const Vector& h) const {
    Vector product = Vector::Zero();
    for (int c = 0; c < extent_; ++c) {
      if (h(c) != 0.0) product.head(extent_) += h(c) * matrix().col(c).head(extent_);
    }
    return product;
  }

  /// Whether every value is finite and no variance negative; otherwise the filter must be restarted.
  [[nodiscard]] bool is_sound() const {
    double sum = 0.0;
    double minimum = 0.0;
    for (int i = 0; i < N; ++i) sum += mean_(i);
    for (int i = 0; i < extent_; ++i) {
      if (is_inactive(i)) continue;  // its row and column are zero
      sum += matrix().col(i).head(extent_).sum();
      minimum = matrix()(i, i) < minimum ? matrix()(i, i) : minimum;
    }
    return math::is_finite(sum) && minimum >= 0.0;
  }

 private:
  [[nodiscard]] Eigen::Map<Matrix> matrix() { return Eigen::Map<Matrix>(elements_.data()); }
  [[nodiscard]] Eigen::Map<const Matrix> matrix() const { return Eigen::Map<const Matrix>(elements_.data()); }

  void extend_to(int i) { extent_ = extent_ > i ? extent_ : i + 1; }

  /// Subtracts ph ph' / variance. Components that are not correlated with the measurement, inactive ones above all,
  /// stay as they are and cost no time.
  void reduce(const Vector& ph, double variance) {
    std::array<std::int16_t, static_cast<std::size_t>(N)> moved;
    std::size_t count = 0;
    for (int i = 0; i < extent_; ++i) {
      if (ph(i) != 0.0) moved[count++] = static_cast<std::int16_t>(i);
    }
    Eigen::Map<Matrix> p = matrix();
    for (std::size_t k = 0; k < count; ++k) {
      const int c = moved[k];
      const double gain = ph(c) / variance;
      for (std::size_t j = k; j < count; ++j) {
        const int r = moved[j];
        const double less = p(r, c) - ph(r) * gain;
        p(r, c) = less;
        p(c, r) = less;
      }
    }
  }

  /// Symmetrises the covariance of the first m components with all others; the others are symmetric among themselves.
  void symmetrise_head(int m) {
    Eigen::Map<Matrix> p = matrix();
    for (int c = 0; c < extent_; ++c) {
      for (int r = 0; r < c && r < m; ++r) {
        const double both = 0.5 * (p(r, c) + p(c, r));
        p(r, c) = both;
        p(c, r) = both;
      }
    }
  }

  Vector mean_ = Vector::Zero();
  std::array<double, static_cast<std::size_t>(N* N)>
      elements_{};  ///< elements of the covariance: Eigen limits the size of its own storage
  int extent_ = 0;  ///< all components from here on are inactive
};

}  // namespace vbar::fsw::estimation
