#pragma once
// The unscented transform as statistical linear regression (Julier, Uhlmann 2004; Lefebvre et al. 2002): the 2M + 1
// sigma points of M components yield the mean, the Jacobian and the nonlinearity of a function without derivatives.
//
// The Jacobian makes the transform usable in a filter whose other components enter linearly (clocks, ambiguities): only
// the nonlinear ones are sampled, and their correlation with the others follows from the Jacobian. Without other
// components this is the unscented Kalman filter with additive noise.

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "fsw/core/result.h"
#include "fsw/math/math.h"

namespace vbar::fsw::estimation {

/// Van der Merwe's parameters: spread alpha, kurtosis beta (2 is best for a Gaussian), kappa.
struct UnscentedParameters {
  double alpha = 1.0;
  double beta = 2.0;
  double kappa = 0.0;
};

/// Sigma points of a mean and covariance, and the regression of function values on them.
template <int M>
class UnscentedTransform {
 public:
  using Vector = Eigen::Matrix<double, M, 1>;
  using Matrix = Eigen::Matrix<double, M, M>;
  static constexpr std::size_t kPoints = 2 * M + 1;

  /// Components of variance zero are inactive: all points have their mean, and their column of the Jacobian is zero.
  /// kSingular if the covariance of the others is not positive definite.
  Status start(const Vector& mean, const Matrix& covariance, const UnscentedParameters& parameters = {}) {
    const double spread2 = parameters.alpha * parameters.alpha * (M + parameters.kappa);
    gamma_ = math::sqrt(spread2);
    const double mean_weight = 1.0 - M / spread2;
    covariance_weight_ = mean_weight + 1.0 - parameters.alpha * parameters.alpha + parameters.beta;
    side_weight_ = 0.5 / spread2;
    mean_ = mean;
    return factorise(covariance);
  }

  /// Whether point k is the mean because its component is inactive: the value of point 0 may be copied.
  [[nodiscard]] bool is_mean(std::size_t k) const {
    return k > 0 && lower_((static_cast<int>(k) - 1) % M, (static_cast<int>(k) - 1) % M) == 0.0;
  }

  /// Returns point k: 0 is the mean, 1 to M lie on one side of the mean, M + 1 to 2 M on the other.
  [[nodiscard]] Vector point(std::size_t k) const {
    if (k == 0) return mean_;
    const int side = static_cast<int>(k) - 1;
    const int column = side % M;
    return side < M ? Vector(mean_ + gamma_ * lower_.col(column)) : Vector(mean_ - gamma_ * lower_.col(column));
  }

  /// A vector function y(x) of the points: mean, Jacobian A = P_yx P_xx^-1 and the nonlinearity covariance about A x.
  template <int K>
  struct Regression {
    Eigen::Matrix<double, K, 1> mean;
    Eigen::Matrix<double, K, M> jacobian;
    Eigen::Matrix<double, K, K> nonlinearity;
  };

  template <int K>
  [[nodiscard]] Regression<K> regress(const std::array<Eigen::Matrix<double, K, 1>, kPoints>& values) const {
    Regression<K> result;
    // About the central value, which preserves a metre in seven thousand kilometres.
    result.mean = Eigen::Matrix<double, K, 1>::Zero();
    for (std::size_t k = 1; k < kPoints; ++k) result.mean += side_weight_ * (values[k] - values[0]);
    const Eigen::Matrix<double, K, 1> shift = result.mean;
    result.mean += values[0];
    result.nonlinearity = (covariance_weight_ * shift).lazyProduct(shift.transpose());
    Eigen::Matrix<double, K, M> along;
    for (int m = 0; m < M; ++m) {
      const Eigen::Matrix<double, K, 1> plus = values[at(m + 1)] - values[0];
      const Eigen::Matrix<double, K, 1> minus = values[at(m + 1 + M)] - values[0];
      along.col(m) = (plus - minus) / (2.0 * gamma_);
      // (plus - shift)(plus - shift)' + (minus - shift)(minus - shift)' without its odd part, which is in the Jacobian.
      const Eigen::Matrix<double, K, 1> even = 0.5 * (plus + minus) - shift;
      result.nonlinearity += (2.0 * side_weight_ * even).lazyProduct(even.transpose());
    }
    // along = Jacobian * lower
    for (int m = M - 1; m >= 0; --m) {
      Eigen::Matrix<double, K, 1> column = along.col(m);
      for (int j = m + 1; j < M; ++j) column -= lower_(j, m) * result.jacobian.col(j);
      if (lower_(m, m) == 0.0) {
        column.setZero();
      } else {
        column /= lower_(m, m);
      }
      result.jacobian.col(m) = column;
    }
    return result;
  }

 private:
  static constexpr std::size_t at(int k) { return static_cast<std::size_t>(k); }

  /// Cholesky: covariance = lower lower'.
  Status factorise(const Matrix& covariance) {
    lower_.setZero();
    for (int c = 0; c < M; ++c) {
      if (covariance(c, c) == 0.0) {
        if (!covariance.row(c).isZero(0.0) || !covariance.col(c).isZero(0.0)) return Status::kSingular;
        continue;
      }
      double pivot = covariance(c, c);
      for (int k = 0; k < c; ++k) pivot -= lower_(c, k) * lower_(c, k);
      if (!(pivot > 0.0) || !math::is_finite(pivot)) return Status::kSingular;
      lower_(c, c) = math::sqrt(pivot);
      for (int r = c + 1; r < M; ++r) {
        double sum = covariance(r, c);
        for (int k = 0; k < c; ++k) sum -= lower_(r, k) * lower_(c, k);
        lower_(r, c) = sum / lower_(c, c);
      }
    }
    return Status::kOk;
  }

  Vector mean_ = Vector::Zero();
  Matrix lower_ = Matrix::Zero();
  double gamma_ = 0.0;
  double covariance_weight_ = 0.0;
  double side_weight_ = 0.0;
};

}  // namespace vbar::fsw::estimation
