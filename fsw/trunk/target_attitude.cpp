#include "fsw/trunk/target_attitude.h"

#include <array>

#include "fsw/estimation/unscented.h"

namespace vbar::fsw::filter {
namespace {

constexpr int kTurn = kAt<Turn>;
constexpr int kRate = kAt<Rate>;

using Transform = estimation::UnscentedTransform<kAttitudeSize>;

}  // namespace

void TargetAttitude::configure(const TargetAttitudeSettings& settings) {
  if (!(settings.angular_acceleration == settings_.angular_acceleration)) {
    noise_ = navigation::AdaptiveNoise(settings.angular_acceleration);
  }
  settings_ = settings;
}

void TargetAttitude::initialize(Estimate& estimate, const navigation::AttitudeState& attitude,
                                const Matrix6& covariance) {
  attitude_ = attitude;
  for (int axis = 0; axis < 3; ++axis) {
    estimate.reset(kTurn + axis, 0.0, 0.0);
    estimate.reset(kRate + axis, attitude.rate_body(axis), 0.0);
  }
  deactivate_block<InertiaRatios>(estimate);
  HeadMotion motion;
  motion.mean = estimate.mean().head<kHeadSize>();
  motion.noise.block<6, 6>(kTurn, kTurn) = covariance;
  estimate.transform_head<kHeadSize>(motion.mean, motion.jacobian, motion.noise);
  noise_.interrupt();
}

void TargetAttitude::deactivate(Estimate& estimate) const {
  deactivate_block<InertiaRatios>(estimate);
  deactivate_block<Rate>(estimate);
  deactivate_block<Turn>(estimate);
}

void TargetAttitude::activate_inertia_ratios(Estimate& estimate) const {
  if (is_active<InertiaRatios>(estimate)) return;
  initialize_block<InertiaRatios>(estimate, {.sigma = settings_.inertia_ratio_sigma});
}

/// The model's tensor with J_yy / J_xx and J_zz / J_xx multiplied by the exponentials: row and column scaled alike, so
/// that it remains positive definite.
navigation::Inertia TargetAttitude::inertia_with(const Vector2& log_ratios) const {
  if (log_ratios.isZero(0.0)) return settings_.inertia;
  const Vector3 scale(1.0, math::exp(0.5 * log_ratios.x()), math::exp(0.5 * log_ratios.y()));
  navigation::Inertia inertia = settings_.inertia;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      inertia.tensor(r, c) *= scale(r) * scale(c);
      inertia.inverse(r, c) /= scale(r) * scale(c);
    }
  }
  return inertia;
}

bool TargetAttitude::advance(const Estimate& estimate, const OrbitStep& step, HeadMotion& motion) {
  if (!is_known(estimate)) return true;
  Transform transform;
  Transform::Vector x = estimate.mean().segment<kAttitudeSize>(kTurn);
  Transform::Matrix covariance;
  for (int r = 0; r < kAttitudeSize; ++r) {
    for (int c = 0; c < kAttitudeSize; ++c) covariance(r, c) = estimate.covariance(kTurn + r, kTurn + c);
  }
  // Points closer than the standard deviation times root of eight: the attitude uncertainty may be twenty degrees.
  if (transform.start(x, covariance, {.alpha = 0.6}) != Status::kOk) return false;
  const auto gradient =
      navigation::gravity_gradient_at(step.servicer.position_eci + 0.5 * step.dt * step.servicer.velocity_eci);
  const navigation::AttitudeState reference =
      navigation::propagate_attitude(attitude_, inertia_with(x.tail<2>()), gradient, step.dt);
  const Eigen::Quaterniond to_reference = reference.q_eci_body.conjugate();
  std::array<Transform::Vector, Transform::kPoints> moved;
  for (std::size_t k = 0; k < Transform::kPoints; ++k) {
    if (transform.is_mean(k)) {
      moved[k] = moved[0];
      continue;
    }
    x = transform.point(k);
    navigation::AttitudeState sample;
    sample.q_eci_body = attitude_.q_eci_body * navigation::quaternion_of_grp(x.head<3>());
    sample.rate_body = x.segment<3>(3);
    const navigation::AttitudeState later =
        navigation::propagate_attitude(sample, inertia_with(x.tail<2>()), gradient, step.dt);
    moved[k] << navigation::grp_of(to_reference * later.q_eci_body), later.rate_body, x.tail<2>();
  }
  const auto regression = transform.regress<kAttitudeSize>(moved);
  motion.mean.segment<kAttitudeSize>(kTurn) = regression.mean;
  motion.jacobian.block<kAttitudeSize, kAttitudeSize>(kTurn, kTurn) = regression.jacobian;
  motion.noise.block<kAttitudeSize, kAttitudeSize>(kTurn, kTurn) = regression.nonlinearity;
  const double psd = noise_.psd();
  for (int axis = 0; axis < 3; ++axis) {
    motion.noise(kTurn + axis, kTurn + axis) += psd * step.dt * step.dt * step.dt / 3.0;
    motion.noise(kTurn + axis, kRate + axis) += psd * step.dt * step.dt / 2.0;
    motion.noise(kRate + axis, kTurn + axis) += psd * step.dt * step.dt / 2.0;
    motion.noise(kRate + axis, kRate + axis) += psd * step.dt;
  }
  attitude_ = reference;
  return true;
}

void TargetAttitude::reset_attitude_error(Estimate& estimate) {
  if (!is_known(estimate)) return;
  const Vector3 rotation = estimate.mean().segment<3>(kTurn);
  attitude_.q_eci_body = (attitude_.q_eci_body * navigation::quaternion_of_grp(rotation)).normalized();
  attitude_.rate_body = estimate.mean().segment<3>(kRate);
  for (int axis = 0; axis < 3; ++axis) estimate.shift(kTurn + axis, -rotation(axis));
}

Matrix6 attitude_covariance(const Estimate& estimate) {
  Matrix6 covariance;
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c < 6; ++c) covariance(r, c) = estimate.covariance(kTurn + r, kTurn + c);
  }
  return covariance;
}

double attitude_sigma(const Estimate& estimate) {
  double greatest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double variance = estimate.variance(kTurn + axis);
    greatest = variance > greatest ? variance : greatest;
  }
  return math::sqrt(greatest);
}

}  // namespace vbar::fsw::filter
