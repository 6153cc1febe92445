#include "fsw/tracking/prediction.h"

#include "fsw/math/math.h"
#include "fsw/tracking/servicer_view.h"

namespace vbar::fsw::tracking {
namespace {

// 1/s: upper bound of the bearing rate of orbits within 60 degrees of the T axis.
constexpr double kUnknownRate = 0.01;
constexpr double kUnknownFraction = 1.0;

template <class Matrix>
bool is_covariance(const Matrix& matrix) {
  for (int k = 0; k < matrix.rows(); ++k) {
    if (!(matrix(k, k) >= 0.0)) return false;
  }
  return math::is_finite(matrix.sum());
}

}  // namespace

Result<Prediction> prediction_of(const orbit::RelativeState& target, const Matrix6& covariance) {
  const Vector3& position = target.position_rtn;
  const Vector3& velocity = target.velocity_rtn;
  const Result<Vector2> slopes = slopes_of(position);
  if (!slopes.ok()) return slopes.status();
  if (!math::is_finite(velocity.sum())) return Status::kNotFinite;
  if (!is_covariance(covariance)) return Status::kOutOfRange;

  const double y = slopes.value().x();
  const double z = slopes.value().y();
  const double inverse = 1.0 / position.y();
  const double y_rate = (velocity.x() - y * velocity.y()) * inverse;
  const double z_rate = (velocity.z() - z * velocity.y()) * inverse;

  Prediction prediction;
  const double stretch_rate = velocity.y() * inverse;
  prediction.slopes << y, z, y_rate, z_rate, stretch_rate;
  Eigen::Matrix<double, 5, 6> jacobian = Eigen::Matrix<double, 5, 6>::Zero();
  jacobian.row(0) << inverse, -y * inverse, 0.0, 0.0, 0.0, 0.0;
  jacobian.row(1) << 0.0, -z * inverse, inverse, 0.0, 0.0, 0.0;
  const double stretch = stretch_rate * inverse;
  jacobian.row(2) << -stretch, (y * velocity.y() * inverse - y_rate) * inverse, 0.0, inverse, -y * inverse, 0.0;
  jacobian.row(3) << 0.0, (z * velocity.y() * inverse - z_rate) * inverse, -stretch, 0.0, -z * inverse, inverse;
  jacobian.row(4) << 0.0, -stretch, 0.0, 0.0, inverse, 0.0;
  const Eigen::Matrix<double, 5, 6> spread = jacobian * covariance;
  prediction.covariance = spread * jacobian.transpose();
  prediction.along_track_m = position.y();
  prediction.along_track_rate = velocity.y();
  prediction.along_track_sigma_fraction = math::sqrt(covariance(1, 1)) * math::abs(inverse);
  return prediction;
}

Result<Prediction> prediction_of(const Vector3& direction_rtn, const Matrix2& covariance, double along_track_m) {
  const Result<Vector2> slopes = slopes_of(direction_rtn);
  if (!slopes.ok()) return slopes.status();
  if (!is_covariance(covariance) || !math::is_finite(along_track_m)) return Status::kOutOfRange;
  Prediction prediction;
  prediction.slopes.head<2>() = slopes.value();
  // An angle is less than its slope by cos^2; the smaller terms are negligible for a gate.
  const double stretch = 1.0 + slopes.value().squaredNorm();
  prediction.covariance.topLeftCorner<2, 2>() = stretch * stretch * covariance;
  for (int k = 2; k < 5; ++k) prediction.covariance(k, k) = kUnknownRate * kUnknownRate;
  prediction.along_track_m = along_track_m;
  prediction.along_track_sigma_fraction = kUnknownFraction;
  return prediction;
}

}  // namespace vbar::fsw::tracking
