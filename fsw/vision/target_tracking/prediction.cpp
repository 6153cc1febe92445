#include "fsw/vision/target_tracking/prediction.h"

#include "fsw/math/math.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "fsw/vision/target_tracking/search_region.h"

namespace vbar::fsw::target_tracking {

Result<ServicerView> servicer_view(const orbit::CartesianState& servicer) {
  const Result<orbit::QnsElements> elements = orbit::qns_from_cartesian(servicer);
  if (!elements.ok()) return elements.status();
  const Result<orbit::QnsElements> mean = orbit::mean_from_osculating(elements.value());
  if (!mean.ok()) return mean.status();

  const Matrix3 rtn_eci = orbit::R_rtn_eci(servicer);
  const Vector3 velocity_rtn = rtn_eci * servicer.velocity_eci;
  const Vector3 acceleration_rtn = rtn_eci * orbit::acceleration_j2(servicer.position_eci);
  const double radius = math::sqrt(servicer.position_eci.squaredNorm());
  const double radial_speed = velocity_rtn.x();
  const double transverse_speed = velocity_rtn.y();
  // Polar coordinates in the orbital plane: d(v_R)/dt = a_R + v_T^2 / r, d(v_T)/dt = a_T - v_R v_T / r.
  const double radial_rate = acceleration_rtn.x() + transverse_speed * transverse_speed / radius;
  const double transverse_rate = acceleration_rtn.y() - radial_speed * transverse_speed / radius;

  ServicerView view;
  view.latitude = orbit::true_argument_of_latitude(elements.value());
  view.latitude_rate = transverse_speed / radius;
  view.mean_motion = orbit::mean_motion(elements.value().a);
  view.drift_rate = -orbit::roe_transition_j2(mean.value(), 1.0)(1, 0);
  view.semi_major_axis = elements.value().a;
  view.path_slope = radial_speed / transverse_speed;
  view.path_slope_rate = (radial_rate - view.path_slope * transverse_rate) / transverse_speed;
  view.path_stretch_rate = transverse_rate / transverse_speed;
  view.plane_rotation_rate = acceleration_rtn.z() / transverse_speed;
  return view;
}

Result<Vector2> slopes_of(const Vector3& direction_rtn) {
  const double norm = math::sqrt(direction_rtn.squaredNorm());
  if (!math::is_finite(norm)) return Status::kNotFinite;
  if (!(math::abs(direction_rtn.y()) > 0.5 * norm)) return Status::kOutOfRange;
  return Vector2(direction_rtn.x() / direction_rtn.y(), direction_rtn.z() / direction_rtn.y());
}

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

Prediction SearchRegion::widened(const Prediction& prediction, double mean_motion) const {
  Prediction wide = prediction;
  if (!is_widened()) return wide;
  // An error of the relative orbit turns with the orbit: its rates are those of an oscillation.
  const double variance = sigma() * sigma();
  const double of_rates = variance * mean_motion * mean_motion;
  wide.covariance.diagonal() += (Vector5() << variance, variance, of_rates, of_rates, of_rates).finished();
  return wide;
}

}  // namespace vbar::fsw::target_tracking
