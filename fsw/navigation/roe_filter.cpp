#include "fsw/navigation/roe_filter.h"

#include "fsw/estimation/unscented.h"
#include "fsw/math/math.h"
#include "fsw/navigation/roe_impulse.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::navigation {
namespace {

using Filter = RoeFilter;

constexpr int kAlongTrack = Filter::State::offset<Filter::DifferentialAccelerations>();
constexpr int kFromSun = kAlongTrack + 1;
constexpr int kBrightness = Filter::State::offset<Filter::BrightnessOffset>();
constexpr int kBias = Filter::State::offset<Filter::BearingBias>();

// Innovations of bearings further apart than this are not neighbours.
constexpr Duration kNeighbours = duration_of_seconds(300);

constexpr double square(double x) {
  return x * x;
}

}  // namespace

Result<orbit::CartesianState> target_from_roe(const orbit::QnsElements& servicer, const Vector6& roe) {
  return orbit::cartesian_from_qns(orbit::qns_from_roe(servicer, roe));
}

Result<Vector6> roe_of_target(const orbit::CartesianState& servicer, const orbit::CartesianState& target) {
  const auto chief = orbit::qns_from_cartesian(servicer);
  const auto deputy = orbit::qns_from_cartesian(target);
  if (!chief.ok()) return chief.status();
  if (!deputy.ok()) return deputy.status();
  return orbit::roe_from_qns(chief.value(), deputy.value());
}

void RoeFilter::begin(const Vector6& roe, const Matrix6& covariance) {
  Eigen::Matrix<double, 8, 8> all = square(settings_.bearing_bias_sigma) * Eigen::Matrix<double, 8, 8>::Identity();
  all.topLeftCorner<6, 6>() = covariance;
  begin(roe, Vector2::Zero(), all);
}

void RoeFilter::begin(const Vector6& roe, const Vector2& bias, const Eigen::Matrix<double, 8, 8>& covariance) {
  Estimate::Vector mean = Estimate::Vector::Zero();
  Estimate::Matrix all = Estimate::Matrix::Zero();
  mean.head<6>() = roe;
  mean(kBrightness) = settings_.brightness_offset_m;
  mean.segment<2>(kBias) = bias;
  all.topLeftCorner<6, 6>() = covariance.topLeftCorner<6, 6>();
  all.block<2, 2>(kBias, kBias) = covariance.bottomRightCorner<2, 2>();
  all.block<6, 2>(0, kBias) = covariance.topRightCorner<6, 2>();
  all.block<2, 6>(kBias, 0) = covariance.bottomLeftCorner<2, 6>();
  all(kAlongTrack, kAlongTrack) = square(settings_.along_track_sigma);
  all(kFromSun, kFromSun) = square(settings_.from_sun_sigma);
  all(kBrightness, kBrightness) = square(settings_.brightness_offset_sigma_m);
  estimate_ = Estimate{};
  estimate_.transform_head<State::kSize>(mean, Estimate::Matrix::Zero(), all);
  started_ = estimate_.is_sound();
}

Result<orbit::CartesianState> RoeFilter::target(const orbit::CartesianState& servicer) const {
  if (!started_) return Status::kNotReady;
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok()) return chief.status();
  return target_from_roe(chief.value(), roe());
}

void RoeFilter::advance(const Propagation& propagation, const orbit::CartesianState& servicer, double dt) {
  if (!started_ || dt <= 0.0) return;
  using Transform = estimation::UnscentedTransform<kSampled>;
  using Sampled = Transform::Vector;
  Transform transform;
  const auto before = orbit::qns_from_cartesian(servicer);
  const auto after = orbit::qns_from_cartesian(propagation.coast(servicer, dt));
  if (!before.ok() || !after.ok() ||
      transform.start(estimate_.mean().head<kSampled>(), estimate_.head_covariance<kSampled>()) != Status::kOk) {
    reset();
    return;
  }
  const double along_track_decay = math::exp(-dt / settings_.along_track_time_s);
  const double from_sun_decay = math::exp(-dt / settings_.from_sun_time_s);
  std::array<Sampled, Transform::kPoints> moved;
  for (std::size_t k = 0; k < Transform::kPoints; ++k) {
    const Sampled x = transform.point(k);
    const auto target = target_from_roe(before.value(), x.head<6>());
    if (!target.ok()) return reset();
    const orbit::CartesianState later = propagation.coast(target.value(), dt, {x(kAlongTrack), x(kFromSun)});
    const auto deputy = orbit::qns_from_cartesian(later);
    if (!deputy.ok()) return reset();
    moved[k] << orbit::roe_from_qns(after.value(), deputy.value()), along_track_decay * x(kAlongTrack),
        from_sun_decay * x(kFromSun);
  }
  const auto regression = transform.regress<kSampled>(moved);

  Estimate::Vector mean = estimate_.mean();
  Estimate::Matrix jacobian = Estimate::Matrix::Identity();
  Estimate::Matrix noise = process_noise(before.value(), dt);
  mean.head<kSampled>() = regression.mean;
  jacobian.topLeftCorner<kSampled, kSampled>() = regression.jacobian;
  noise.topLeftCorner<kSampled, kSampled>() += regression.nonlinearity;
  const double brightness_decay = math::exp(-dt / settings_.brightness_offset_time_s);
  const double bias_decay = math::exp(-dt / settings_.bearing_bias_time_s);
  mean(kBrightness) =
      settings_.brightness_offset_m + brightness_decay * (mean(kBrightness) - settings_.brightness_offset_m);
  jacobian(kBrightness, kBrightness) = brightness_decay;
  for (int axis = 0; axis < 2; ++axis) {
    mean(kBias + axis) *= bias_decay;
    jacobian(kBias + axis, kBias + axis) = bias_decay;
  }
  estimate_.transform_head<State::kSize>(mean, jacobian, noise);
  if (!estimate_.is_sound()) reset();
}

/// White accelerations in RTN, by three-point Gauss quadrature in the interval: Gamma maps an impulse to the elements,
/// and only the mean longitude drifts. The Gauss-Markov states receive the noise that keeps their variance.
RoeFilter::Estimate::Matrix RoeFilter::process_noise(const orbit::QnsElements& servicer, double dt) const {
  constexpr std::array<double, 3> kAt = {0.1127016653792583, 0.5, 0.8872983346207417};
  constexpr std::array<double, 3> kWeight = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  Estimate::Matrix noise = Estimate::Matrix::Zero();
  const double n = orbit::mean_motion(servicer.a);
  for (std::size_t k = 0; k < 3; ++k) {
    orbit::QnsElements then = servicer;
    then.u += n * kAt[k] * dt;
    Matrix63 gamma = orbit::roe_control_matrix_near_circular(then);
    gamma.row(1) -= 1.5 * n * (1.0 - kAt[k]) * dt * gamma.row(0);
    for (int axis = 0; axis < 3; ++axis) {
      noise.topLeftCorner<6, 6>() +=
          (kWeight[k] * dt * noise_.psd() * gamma.col(axis)).lazyProduct(gamma.col(axis).transpose());
    }
  }
  const auto renewed = [dt](double sigma, double time) { return square(sigma) * (1.0 - math::exp(-2.0 * dt / time)); };
  noise(kAlongTrack, kAlongTrack) = renewed(settings_.along_track_sigma, settings_.along_track_time_s);
  noise(kFromSun, kFromSun) = renewed(settings_.from_sun_sigma, settings_.from_sun_time_s);
  noise(kBrightness, kBrightness) = renewed(settings_.brightness_offset_sigma_m, settings_.brightness_offset_time_s);
  for (int axis = 0; axis < 2; ++axis) {
    noise(kBias + axis, kBias + axis) = renewed(settings_.bearing_bias_sigma, settings_.bearing_bias_time_s);
  }
  return noise;
}

void RoeFilter::add_servicer_impulse(const orbit::CartesianState& servicer, const Vector3& dv_eci) {
  if (!started_) return;
  const double sigma = settings_.maneuver_sigma + settings_.maneuver_sigma_relative * math::sqrt(dv_eci.squaredNorm());
  if (!move_frame_of_roe(estimate_, servicer, dv_eci, sigma)) return reset();
  noise_.interrupt();
  if (!estimate_.is_sound()) reset();
}

Result<RoeFilter::Model> RoeFilter::model_of(const Matrix3& axes, const Vector3& origin_eci,
                                             const orbit::CartesianState& servicer, const Vector3& sun_eci) const {
  using Transform = estimation::UnscentedTransform<6>;
  Transform transform;
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok()) return chief.status();
  if (const Status status = transform.start(roe(), roe_covariance()); status != Status::kOk) return status;
  const Vector3 camera = servicer.position_eci + origin_eci;
  std::array<Vector2, Transform::kPoints> values;
  Model model;
  model.jacobian.setZero();
  for (std::size_t k = 0; k < Transform::kPoints; ++k) {
    const auto target = target_from_roe(chief.value(), transform.point(k));
    if (!target.ok()) return target.status();
    const Vector3 sight =
        centre_of_brightness(target.value().position_eci, camera, sun_eci, estimate_.mean(kBrightness)) - camera;
    const double range = math::sqrt(sight.squaredNorm());
    values[k] = axes.topRows<2>() * sight / range;
    if (k == 0)
      model.jacobian.col(kBrightness) =
          axes.topRows<2>() * (sun_eci - sight.dot(sun_eci) / (range * range) * sight) / range;
  }
  const auto regression = transform.regress<2>(values);
  model.value = regression.mean + estimate_.mean().segment<2>(kBias);
  model.jacobian.leftCols<6>() = regression.jacobian;
  model.jacobian.block<2, 2>(0, kBias) = Matrix2::Identity();
  model.nonlinearity = regression.nonlinearity;
  return model;
}

BearingUpdate RoeFilter::take(const BearingMeasurement& bearing, const orbit::CartesianState& servicer,
                              const Vector3& sun_eci) {
  BearingUpdate update;
  if (!started_) return update;
  const Matrix3 axes = bearing_axes(bearing.direction_eci, servicer);
  const auto model = model_of(axes, bearing.origin_eci, servicer, sun_eci);
  if (!model.ok()) return update;
  const auto& h = model.value().jacobian;
  update.prefit = -model.value().value;  // the components of the measured direction across itself are zero
  const double variance = square(bearing.sigma) + square(settings_.resolved_share * bearing.apparent_radius);
  const Matrix2 noise = model.value().nonlinearity + variance * Matrix2::Identity();
  Eigen::Matrix<double, 2, State::kSize> hp = Eigen::Matrix<double, 2, State::kSize>::Zero();
  for (int i = 0; i < State::kSize; ++i) {
    for (int j = 0; j < State::kSize; ++j) hp.col(i) += h.col(j) * estimate_.covariance(j, i);
  }
  const Matrix2 innovation = hp.lazyProduct(h.transpose()) + noise;
  const double determinant = innovation(0, 0) * innovation(1, 1) - innovation(0, 1) * innovation(1, 0);
  if (!(determinant > 0.0)) return update;
  const Vector2& r = update.prefit;
  update.normalised = {r(0) / math::sqrt(innovation(0, 0)), r(1) / math::sqrt(innovation(1, 1))};
  update.nis =
      (innovation(1, 1) * r(0) * r(0) - 2.0 * innovation(0, 1) * r(0) * r(1) + innovation(0, 0) * r(1) * r(1)) /
      determinant;
  update.postfit = update.prefit;
  if (!(update.nis <= settings_.gate)) return update;

  // One after the other, the second decorrelated from the first.
  constexpr double kNoGate = 1e300;
  const double shared = noise(1, 0) / noise(0, 0);
  const Estimate::Vector old = estimate_.mean();
  const Estimate::Vector first = h.row(0).transpose();
  const Estimate::Vector second = h.row(1).transpose() - shared * first;
  estimate_.update(first, r(0), noise(0, 0), kNoGate);
  const double rest = r(1) - shared * r(0) - second.dot(estimate_.mean() - old);
  estimate_.update(second, rest, noise(1, 1) - shared * noise(0, 1), kNoGate);
  update.accepted = true;
  update.postfit = r - h.lazyProduct(estimate_.mean() - old);
  adapt(bearing, update);
  if (!estimate_.is_sound()) reset();
  return update;
}

/// Only for bearings to an unresolved target: the centroid of a disk varies with its attitude, which resembles a lag.
void RoeFilter::adapt(const BearingMeasurement& bearing, const BearingUpdate& update) {
  if (bearing.time - last_bearing_ > kNeighbours) noise_.interrupt();
  last_bearing_ = bearing.time;
  if (settings_.resolved_share * bearing.apparent_radius < bearing.sigma) noise_.take(update.normalised);
}

Result<BearingPrediction> RoeFilter::predict(const orbit::CartesianState& servicer, const Vector3& origin_eci,
                                             const Vector3& sun_eci) const {
  const auto seen = target(servicer);
  if (!seen.ok()) return seen.status();
  BearingPrediction prediction;
  const Vector3 camera = servicer.position_eci + origin_eci;
  const Vector3 sight =
      centre_of_brightness(seen.value().position_eci, camera, sun_eci, estimate_.mean(kBrightness)) - camera;
  prediction.direction_eci = sight / math::sqrt(sight.squaredNorm());
  const auto model = model_of(bearing_axes(prediction.direction_eci, servicer), origin_eci, servicer, sun_eci);
  if (!model.ok()) return model.status();
  const auto& h = model.value().jacobian;
  for (int i = 0; i < State::kSize; ++i) {
    for (int j = 0; j < State::kSize; ++j) {
      prediction.covariance += estimate_.covariance(i, j) * h.col(i) * h.col(j).transpose();
    }
  }
  prediction.covariance += model.value().nonlinearity;
  return prediction;
}

void RoeFilter::inflate_covariance(const orbit::CartesianState& servicer, double velocity_sigma,
                                   double longitude_share) {
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!started_ || !chief.ok()) return;
  const Matrix63 gamma = orbit::roe_control_matrix(chief.value());
  Matrix6 noise = (square(velocity_sigma) * gamma).lazyProduct(gamma.transpose());
  noise(1, 1) += square(longitude_share * roe()(1));
  estimate_.transform_head<6>(roe(), Matrix6::Identity(), noise);
  noise_.interrupt();
}

}  // namespace vbar::fsw::navigation
