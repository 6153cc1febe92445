#pragma once
// A Gaussian estimate, and what a filter does to it by ones: forget a component, add noise, fold in a scalar
// measurement. All of it works in place: at 80 components a second covariance would not fit a flight computer's stack.
//
// Components may be idle (an ambiguity of a satellite not in view): their variance is zero, and no operation touches
// them.
//
// Products are Eigen's lazy ones: its blocked kernels for larger matrices keep a way to the heap in the object code.

#include <Eigen/Core>

#include "fsw/core/result.h"
#include "fsw/math/math.h"

namespace vbar::fsw::estimation {

/// What came of a scalar measurement.
struct Innovation {
  double value = 0.0;     ///< measured minus predicted
  double variance = 0.0;  ///< predicted, of the estimate and the noise together
  bool accepted = false;

  /// Squared and normalised: chi-square with one degree of freedom if the filter is honest.
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

  /// Component i is `mean` with `variance`, independent of all others; variance 0 puts it to rest.
  void reset(int i, double mean, double variance) {
    mean_(i) = mean;
    covariance_.row(i).setZero();
    covariance_.col(i).setZero();
    covariance_(i, i) = variance;
  }

  /// Shifts the mean: a known change, as a burn.
  void shift(int i, double by) { mean_(i) += by; }

  /// Component i shrinks to `factor` of itself, as one that fades.
  void scale(int i, double factor) {
    mean_(i) *= factor;
    covariance_.row(i) *= factor;
    covariance_.col(i) *= factor;
  }

  /// Independent noise on component i.
  void add_noise(int i, double variance) { covariance_(i, i) += variance; }

  /// The first M components move by x <- mean + A (x - old mean) plus independent noise of covariance Q.
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

  /// What a measurement with the linear(ised) model z = h x + noise would show: its innovation, not folded in.
  /// `residual`: measured minus predicted.
  [[nodiscard]] Innovation predict(const Vector& h, double residual, double noise_variance) const {
    return {.value = residual, .variance = h.dot(covariance_times(h)) + noise_variance, .accepted = false};
  }

  /// Folds it in unless nis() exceeds `gate`, or anything is not finite.
  Innovation update(const Vector& h, double residual, double noise_variance, double gate) {
    const Vector ph = covariance_times(h);
    Innovation innovation{.value = residual, .variance = h.dot(ph) + noise_variance, .accepted = false};
    // Written so that a NaN is refused.
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

  /// Whether every number is finite and no variance negative: a filter that fails it must start again.
  [[nodiscard]] bool is_sound() const {
    double sum = 0.0;
    double least = 0.0;
    for (int i = 0; i < N; ++i) {
      sum += mean_(i) + covariance_.col(i).sum();
      least = covariance_(i, i) < least ? covariance_(i, i) : least;
    }
    return math::is_finite(sum) && least >= 0.0;
  }

 private:
  /// P h. A measurement sees few of the components; the columns of the others are left out.
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
