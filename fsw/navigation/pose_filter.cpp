#include "fsw/navigation/pose_filter.h"

#include "fsw/estimation/unscented.h"
#include "fsw/math/math.h"
#include "fsw/navigation/dynamics.h"
#include "fsw/navigation/propagation.h"
#include "fsw/navigation/roe_impulse.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::navigation {
namespace {

using Filter = PoseFilter;

constexpr int kRotation = Filter::State::offset<Filter::Attitude>();
constexpr int kRate = Filter::State::offset<Filter::Rate>();
constexpr int kAccelerations = Filter::State::offset<Filter::DifferentialAccelerations>();
constexpr int kCommon = Filter::State::offset<Filter::Common>();
constexpr int kErrors = Filter::State::offset<Filter::KeypointError>();

constexpr double square(double x) {
  return x * x;
}

bool is_positive(double x) {
  return x > 0.0 && math::is_finite(x);
}

/// Rows and columns of a covariance.
template <int M, std::size_t S>
Eigen::Matrix<double, M, M> covariance_of(const Filter::Estimate& estimate, const std::array<int, S>& at) {
  static_assert(M == static_cast<int>(S));
  Eigen::Matrix<double, M, M> covariance;
  for (int r = 0; r < M; ++r) {
    for (int c = 0; c < M; ++c) {
      covariance(r, c) = estimate.covariance(at[static_cast<std::size_t>(r)], at[static_cast<std::size_t>(c)]);
    }
  }
  return covariance;
}

constexpr std::array<int, 8> kOrbitStates = {0, 1, 2, 3, 4, 5, kAccelerations, kAccelerations + 1};
constexpr std::array<int, 6> kAttitudeStates = {kRotation, kRotation + 1, kRotation + 2, kRate, kRate + 1, kRate + 2};

}  // namespace

Status PoseFilter::configure(const PoseFilterSettings& settings) {
  started_ = false;
  const auto inertia = inertia_of(settings.inertia);
  if (!inertia.ok()) return inertia.status();
  const bool is_sensible = is_positive(settings.along_track_time_s) && is_positive(settings.from_sun_time_s) &&
                           is_positive(settings.correlation_angle) && is_positive(settings.correlation_time_s) &&
                           is_positive(settings.lasting_stretch_time_s) && settings.correlated_share >= 0.0 &&
                           settings.correlated_share < 1.0;
  if (!is_sensible) return Status::kOutOfRange;
  settings_ = settings;
  inertia_ = inertia.value();
  acceleration_noise_ = AdaptiveNoise(settings.acceleration);
  angular_noise_ = AdaptiveNoise(settings.angular_acceleration);
  learned_scale_ = 1.0;
  update_ = {};
  return Status::kOk;
}

void PoseFilter::begin(const Vector6& roe, const Matrix6& roe_covariance, const AttitudeState& attitude,
                       const Matrix6& attitude_covariance) {
  for (int k = 0; k < State::kSize; ++k) estimate_.reset(k, 0.0, 0.0);
  estimate_.transform_head<6>(roe, Matrix6::Identity(), roe_covariance);
  estimate_.reset(kAccelerations, 0.0, square(settings_.along_track_sigma));
  estimate_.reset(kAccelerations + 1, 0.0, square(settings_.from_sun_sigma));
  acceleration_noise_.interrupt();
  set_attitude(attitude, attitude_covariance);
  started_ = estimate_.is_sound();
}

void PoseFilter::set_attitude(const AttitudeState& attitude, const Matrix6& attitude_covariance) {
  attitude_ = attitude;
  for (int axis = 0; axis < 3; ++axis) {
    estimate_.reset(kRotation + axis, 0.0, 0.0);
    estimate_.reset(kRate + axis, attitude.rate_body(axis), 0.0);
  }
  reset_error_states();
  Moving noise = Moving::Zero();
  noise.block<6, 6>(kRotation, kRotation) = attitude_covariance;
  const Eigen::Matrix<double, kMoving, 1> mean = estimate_.mean().head<kMoving>();
  estimate_.transform_head<kMoving>(mean, Moving::Identity(), noise);
  angular_noise_.interrupt();
}

void PoseFilter::inflate_position(double sigma_m, double semi_major_axis_m) {
  constexpr int kAlongTrack = 1;
  estimate_.add_noise(kAlongTrack, square(sigma_m / semi_major_axis_m));
}

void PoseFilter::reset_error_states() {
  for (int axis = 0; axis < 2; ++axis) estimate_.reset(kCommon + axis, 0.0, square(settings_.shift_sigma_px));
  estimate_.reset(kCommon + 2, 0.0, square(settings_.stretch_sigma));
  estimate_.reset(kCommon + 3, 0.0, square(settings_.lasting_stretch_sigma));
  for (int k = 0; k < KeypointError::kSize; ++k) estimate_.reset(kErrors + k, 0.0, 1.0);
}

Matrix6 PoseFilter::attitude_covariance() const {
  return covariance_of<6>(estimate_, kAttitudeStates);
}

double PoseFilter::attitude_sigma() const {
  double maximum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double variance = estimate_.variance(kRotation + axis);
    maximum = variance > maximum ? variance : maximum;
  }
  return math::sqrt(maximum);
}

Result<orbit::CartesianState> PoseFilter::target(const orbit::CartesianState& servicer) const {
  if (!started_) return Status::kNotReady;
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok()) return chief.status();
  return target_from_roe(chief.value(), roe());
}

/// By differences; at this range the map is practically linear.
Matrix3 PoseFilter::position_covariance(const orbit::CartesianState& servicer) const {
  constexpr double kDifferenceStep = 1e-7;
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok() || !started_) return Matrix3::Zero();
  Eigen::Matrix<double, 3, 6> jacobian;
  for (int k = 0; k < 6; ++k) {
    const auto plus = target_from_roe(chief.value(), roe() + kDifferenceStep * Vector6::Unit(k));
    const auto minus = target_from_roe(chief.value(), roe() - kDifferenceStep * Vector6::Unit(k));
    if (!plus.ok() || !minus.ok()) return Matrix3::Zero();
    jacobian.col(k) = (plus.value().position_eci - minus.value().position_eci) / (2.0 * kDifferenceStep);
  }
  return jacobian.lazyProduct(roe_covariance()).lazyProduct(jacobian.transpose());
}

void PoseFilter::advance(const orbit::CartesianState& servicer, const Vector3& sun_eci, double dt) {
  if (!started_ || dt <= 0.0) return;
  Moving jacobian = Moving::Identity();
  Moving noise = Moving::Zero();
  Eigen::Matrix<double, kMoving, 1> mean = estimate_.mean().head<kMoving>();
  advance_orbit(servicer, sun_eci, dt, jacobian, noise, mean);
  if (started_) advance_attitude(servicer, dt, jacobian, noise, mean);
  if (!started_) return;
  estimate_.transform_head<kMoving>(mean, jacobian, noise);
  reset_attitude_error();
  decay_errors(dt);
  since_update_s_ += dt;
  if (!estimate_.is_sound()) reset();
}

/// Both orbits under point mass and J2: at ten metres, the neglected terms cause a relative acceleration of less
/// than 3e-9 m/s^2.
void PoseFilter::advance_orbit(const orbit::CartesianState& servicer, const Vector3& sun_eci, double dt,
                               Moving& jacobian, Moving& noise, Eigen::Matrix<double, kMoving, 1>& mean) {
  using Transform = estimation::UnscentedTransform<8>;
  using Sampled = Transform::Vector;
  Transform transform;
  const auto before = orbit::qns_from_cartesian(servicer);
  const auto after = orbit::qns_from_cartesian(propagate_accelerated(servicer, Vector3::Zero(), dt));
  Sampled x;
  x << roe(), estimate_.mean(kAccelerations), estimate_.mean(kAccelerations + 1);
  if (!before.ok() || !after.ok() || transform.start(x, covariance_of<8>(estimate_, kOrbitStates)) != Status::kOk) {
    return reset();
  }
  const double along_track_decay = math::exp(-dt / settings_.along_track_time_s);
  const double from_sun_decay = math::exp(-dt / settings_.from_sun_time_s);
  const bool is_lit = is_sunlit(servicer.position_eci, sun_eci);
  const Vector3 from_sun_rtn = is_lit ? Vector3(-(orbit::R_rtn_eci(servicer) * sun_eci)) : Vector3(Vector3::Zero());
  std::array<Sampled, Transform::kPoints> moved;
  for (std::size_t k = 0; k < Transform::kPoints; ++k) {
    x = transform.point(k);
    const auto target = target_from_roe(before.value(), x.head<6>());
    if (!target.ok()) return reset();
    const Vector3 acceleration_rtn = Vector3(0.0, x(6), 0.0) + x(7) * from_sun_rtn;
    const auto deputy = orbit::qns_from_cartesian(propagate_accelerated(target.value(), acceleration_rtn, dt));
    if (!deputy.ok()) return reset();
    moved[k] << orbit::roe_from_qns(after.value(), deputy.value()), along_track_decay * x(6), from_sun_decay * x(7);
  }
  const auto regression = transform.regress<8>(moved);
  for (int r = 0; r < 8; ++r) {
    const int row = kOrbitStates[static_cast<std::size_t>(r)];
    mean(row) = regression.mean(r);
    for (int c = 0; c < 8; ++c) {
      const int column = kOrbitStates[static_cast<std::size_t>(c)];
      jacobian(row, column) = regression.jacobian(r, c);
      noise(row, column) = regression.nonlinearity(r, c);
    }
  }

  // White accelerations in RTN by three-point Gauss quadrature, as in fsw/trunk/relative_orbit.cpp.
  constexpr std::array<double, 3> kAt = {0.1127016653792583, 0.5, 0.8872983346207417};
  constexpr std::array<double, 3> kWeight = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const double n = orbit::mean_motion(before.value().a);
  for (std::size_t k = 0; k < 3; ++k) {
    orbit::QnsElements then = before.value();
    then.u += n * kAt[k] * dt;
    Matrix63 gamma = orbit::roe_control_matrix_near_circular(then);
    gamma.row(1) -= 1.5 * n * (1.0 - kAt[k]) * dt * gamma.row(0);
    const double weight = kWeight[k] * dt * acceleration_noise_.psd();
    noise.topLeftCorner<6, 6>() += (weight * gamma).lazyProduct(gamma.transpose());
  }
  noise(kAccelerations, kAccelerations) += square(settings_.along_track_sigma) * (1.0 - square(along_track_decay));
  noise(kAccelerations + 1, kAccelerations + 1) += square(settings_.from_sun_sigma) * (1.0 - square(from_sun_decay));
}

void PoseFilter::advance_attitude(const orbit::CartesianState& servicer, double dt, Moving& jacobian, Moving& noise,
                                  Eigen::Matrix<double, kMoving, 1>& mean) {
  using Transform = estimation::UnscentedTransform<6>;
  Transform transform;
  Vector6 x = Vector6::Zero();
  x.tail<3>() = attitude_.rate_body;
  // Points closer than the standard deviation times root of six: the attitude uncertainty may be twenty degrees.
  if (transform.start(x, attitude_covariance(), {.alpha = 0.7}) != Status::kOk) return reset();
  const GravityGradient gradient = gravity_gradient_at(servicer.position_eci + 0.5 * dt * servicer.velocity_eci);
  const AttitudeState reference = propagate_attitude(attitude_, inertia_, gradient, dt);
  const Eigen::Quaterniond to_reference = reference.q_eci_body.conjugate();
  std::array<Vector6, Transform::kPoints> moved;
  for (std::size_t k = 0; k < Transform::kPoints; ++k) {
    x = transform.point(k);
    AttitudeState sample;
    sample.q_eci_body = attitude_.q_eci_body * quaternion_of_grp(x.head<3>());
    sample.rate_body = x.tail<3>();
    const AttitudeState later = propagate_attitude(sample, inertia_, gradient, dt);
    moved[k] << grp_of(to_reference * later.q_eci_body), later.rate_body;
  }
  const auto regression = transform.regress<6>(moved);
  mean.segment<6>(kRotation) = regression.mean;
  jacobian.block<6, 6>(kRotation, kRotation) = regression.jacobian;
  noise.block<6, 6>(kRotation, kRotation) = regression.nonlinearity;
  const double psd = angular_noise_.psd();
  for (int axis = 0; axis < 3; ++axis) {
    noise(kRotation + axis, kRotation + axis) += psd * dt * dt * dt / 3.0;
    noise(kRotation + axis, kRate + axis) += psd * dt * dt / 2.0;
    noise(kRate + axis, kRotation + axis) += psd * dt * dt / 2.0;
    noise(kRate + axis, kRate + axis) += psd * dt;
  }
  attitude_ = reference;
}

/// The estimated rotation is moved into the reference quaternion.
void PoseFilter::reset_attitude_error() {
  const Vector3 rotation = estimate_.mean().segment<3>(kRotation);
  attitude_.q_eci_body = (attitude_.q_eci_body * quaternion_of_grp(rotation)).normalized();
  attitude_.rate_body = estimate_.mean().segment<3>(kRate);
  for (int axis = 0; axis < 3; ++axis) estimate_.shift(kRotation + axis, -rotation(axis));
}

void PoseFilter::decay_errors(double dt) {
  const auto decay = [&](int component, double sigma, double factor) {
    estimate_.scale(component, factor);
    estimate_.add_noise(component, square(sigma) * (1.0 - square(factor)));
  };
  const double rate = math::sqrt(attitude_.rate_body.squaredNorm());
  const double view = math::exp(-dt * (rate / settings_.correlation_angle + 1.0 / settings_.correlation_time_s));
  decay(kCommon, settings_.shift_sigma_px, view);
  decay(kCommon + 1, settings_.shift_sigma_px, view);
  decay(kCommon + 2, settings_.stretch_sigma, view);
  decay(kCommon + 3, settings_.lasting_stretch_sigma, math::exp(-dt / settings_.lasting_stretch_time_s));
  for (int k = 0; k < KeypointError::kSize; ++k) decay(kErrors + k, 1.0, view);
}

void PoseFilter::add_servicer_impulse(const orbit::CartesianState& servicer, const Vector3& dv_eci) {
  if (!started_) return;
  const double sigma = settings_.maneuver_sigma + settings_.maneuver_sigma_relative * math::sqrt(dv_eci.squaredNorm());
  if (!move_frame_of_roe(estimate_, servicer, dv_eci, sigma)) return reset();
  acceleration_noise_.interrupt();
  if (!estimate_.is_sound()) reset();
}

}  // namespace vbar::fsw::navigation
