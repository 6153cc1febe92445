#include "fsw/measurements/cdgnss/displacement_test.h"

#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"

namespace vbar::fsw::measurements {
namespace {

constexpr int kMaxLeftOut = 4;
constexpr double kOutlier = 16.0;  // normalised square of a measurement that no displacement explains

}  // namespace

void DisplacementTest::clear() {
  count_ = 0;
  covariance_.setIdentity();
  innovation_.setZero();
  direction_.setZero();
}

void DisplacementTest::add(double innovation_m, const Vector3& direction) {
  if (is_full()) return;
  innovation_(count_) = innovation_m;
  direction_.row(count_) = direction.transpose();
  ++count_;
}

void DisplacementTest::set_covariance(int row, int column, double covariance_m2) {
  covariance_(row, column) = covariance_m2;
  covariance_(column, row) = covariance_m2;
}

/// A row of the identity without an innovation has no influence.
void DisplacementTest::leave_out(int row) {
  covariance_.row(row).setZero();
  covariance_.col(row).setZero();
  covariance_(row, row) = 1.0;
  innovation_(row) = 0.0;
  direction_.row(row).setZero();
}

Displacement DisplacementTest::evaluate(double gate, double max_rest) {
  Displacement best;
  int used = count_;
  for (int left_out = 0; left_out <= kMaxLeftOut && used >= kMinRows; ++left_out) {
    const math::Cholesky<kMaxRows> factor(covariance_);
    if (!factor.ok()) return best;
    const Vector y = factor.solve_lower(innovation_);
    Eigen::Matrix<double, kMaxRows, 3> g;
    for (int axis = 0; axis < 3; ++axis) g.col(axis) = factor.solve_lower(direction_.col(axis));
    const Matrix3 information = g.transpose().lazyProduct(g);
    const math::Cholesky<3> normal(information);
    if (!normal.ok()) return best;
    best.metres = normal.solve(g.transpose().lazyProduct(y));
    best.ratio = best.metres.dot(information * best.metres);
    best.is_tested = math::is_finite(best.ratio);
    const double rest = y.squaredNorm() - best.ratio;
    if (!best.is_tested || !(best.ratio > gate)) return best;
    if (rest <= max_rest * (used - 3)) {
      best.is_detected = true;
      return best;
    }
    // The worst outlier: its residual given all others, over their standard deviation.
    const Vector residual = factor.solve(innovation_ - direction_.lazyProduct(best.metres));
    int worst = -1;
    double largest = kOutlier;
    for (int row = 0; row < count_; ++row) {
      const double inverse_variance = factor.solve_lower(Vector::Unit(row)).squaredNorm();
      const double square = residual(row) * residual(row) / inverse_variance;
      if (square > largest) {
        largest = square;
        worst = row;
      }
    }
    if (worst < 0) return best;
    leave_out(worst);
    --used;
  }
  best.is_detected = false;
  return best;
}

}  // namespace vbar::fsw::measurements
