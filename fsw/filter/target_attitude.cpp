#include "fsw/filter/target_attitude.h"

#include <array>

#include "fsw/estimation/unscented.h"
#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"
#include "fsw/orbit/gravity_field.h"

namespace vbar::fsw::filter {

namespace {

constexpr double kMaxStep_s = 2.5;
constexpr int kMaxSteps = 1440;

using Vector4 = Eigen::Matrix<double, 4, 1>;

struct Rates {
  Vector4 quaternion;  // x, y, z, w
  Vector3 rate;
};

Rates rates_of(const Vector4& q, const Vector3& rate, const Inertia& inertia, const GravityGradient& gradient) {
  Rates d;
  const Vector3 v = q.head<3>();
  d.quaternion.head<3>() = 0.5 * (q(3) * rate + v.cross(rate));
  d.quaternion(3) = -0.5 * v.dot(rate);
  Vector3 torque = (inertia.tensor * rate).cross(rate);
  if (gradient.strength != 0.0) {
    // R_body_eci u without the matrix; the length of q is 1 to the rounding errors of the integration.
    const Vector3 across = 2.0 * gradient.vertical_eci.cross(v);
    const Vector3 vertical = gradient.vertical_eci + q(3) * across + across.cross(v);
    torque += gradient.strength * vertical.cross(inertia.tensor * vertical);
  }
  d.rate = inertia.inverse * torque;
  return d;
}

Vector4 normalised(const Vector4& q) {
  return q / math::sqrt(q.squaredNorm());
}

}  // namespace

Result<Inertia> inertia_of(const Matrix3& tensor) {
  if (!math::is_finite(tensor.sum())) return Status::kNotFinite;
  const double asymmetry = (tensor - tensor.transpose()).cwiseAbs().maxCoeff();
  const math::Cholesky<3> factor(tensor);
  if (!factor.ok() || !(asymmetry <= 1e-9 * tensor.diagonal().maxCoeff())) return Status::kOutOfRange;
  return Inertia{tensor, factor.inverse()};
}

GravityGradient gravity_gradient_at(const Vector3& position_eci) {
  const double r2 = position_eci.squaredNorm();
  const double r = math::sqrt(r2);
  return {.vertical_eci = position_eci / r, .strength = 3.0 * orbit::kMu / (r2 * r)};
}

AttitudeState propagate_attitude(const AttitudeState& state, const Inertia& inertia, const GravityGradient& gradient,
                                 double dt) {
  int steps = 1;
  while (steps < kMaxSteps && math::abs(dt) > steps * kMaxStep_s) ++steps;
  const double h = dt / steps;
  Vector4 q = state.q_eci_body.coeffs();
  Vector3 rate = state.rate_body;
  for (int k = 0; k < steps; ++k) {
    const Rates a = rates_of(q, rate, inertia, gradient);
    const Rates b = rates_of(q + 0.5 * h * a.quaternion, rate + 0.5 * h * a.rate, inertia, gradient);
    const Rates c = rates_of(q + 0.5 * h * b.quaternion, rate + 0.5 * h * b.rate, inertia, gradient);
    const Rates d = rates_of(q + h * c.quaternion, rate + h * c.rate, inertia, gradient);
    q = normalised(q + h / 6.0 * (a.quaternion + 2.0 * b.quaternion + 2.0 * c.quaternion + d.quaternion));
    rate += h / 6.0 * (a.rate + 2.0 * b.rate + 2.0 * c.rate + d.rate);
  }
  AttitudeState later;
  later.q_eci_body.coeffs() = q;
  later.rate_body = rate;
  return later;
}

Vector3 grp_of(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  return 4.0 * sign / (1.0 + math::abs(q.w())) * q.vec();
}

Eigen::Quaterniond quaternion_of_grp(const Vector3& grp) {
  const double square = grp.squaredNorm();
  const double w = (16.0 - square) / (16.0 + square);
  Eigen::Quaterniond q;
  q.w() = w;
  q.vec() = 0.25 * (1.0 + w) * grp;
  return q;
}

Vector3 rotation_vector_of(const Eigen::Quaterniond& q) {
  const double sine = math::sqrt(q.vec().squaredNorm());
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  if (sine < 1e-12) return 2.0 * sign * q.vec();
  return 2.0 * sign * math::atan2(sine, math::abs(q.w())) / sine * q.vec();
}

Eigen::Quaterniond quaternion_of_rotation_vector(const Vector3& rotation) {
  const double angle = math::sqrt(rotation.squaredNorm());
  Eigen::Quaterniond q;
  q.w() = math::cos(0.5 * angle);
  q.vec() = angle < 1e-12 ? Vector3(0.5 * rotation) : Vector3(math::sin(0.5 * angle) / angle * rotation);
  return q;
}

namespace {

constexpr int kTurn = kAt<AttitudeError>;
constexpr int kRate = kAt<Rate>;

using Transform = estimation::UnscentedTransform<kAttitudeSize>;

}  // namespace

void TargetAttitude::configure(const TargetAttitudeSettings& settings) {
  if (!(settings.angular_acceleration == settings_.angular_acceleration)) {
    noise_ = filter::AdaptiveNoise(settings.angular_acceleration);
  }
  settings_ = settings;
}

void TargetAttitude::initialize(Estimate& estimate, const filter::AttitudeState& attitude, const Matrix6& covariance) {
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
  deactivate_block<AttitudeError>(estimate);
}

void TargetAttitude::activate_inertia_ratios(Estimate& estimate) const {
  if (is_active<InertiaRatios>(estimate)) return;
  initialize_block<InertiaRatios>(estimate, {.sigma = settings_.inertia_ratio_sigma});
}

/// The model's tensor with J_yy / J_xx and J_zz / J_xx multiplied by the exponentials: row and column scaled alike, so
/// that it remains positive definite.
filter::Inertia TargetAttitude::inertia_with(const Vector2& log_ratios) const {
  if (log_ratios.isZero(0.0)) return settings_.inertia;
  const Vector3 scale(1.0, math::exp(0.5 * log_ratios.x()), math::exp(0.5 * log_ratios.y()));
  filter::Inertia inertia = settings_.inertia;
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
      filter::gravity_gradient_at(step.servicer.position_eci + 0.5 * step.dt * step.servicer.velocity_eci);
  const filter::AttitudeState reference =
      filter::propagate_attitude(attitude_, inertia_with(x.tail<2>()), gradient, step.dt);
  const Eigen::Quaterniond to_reference = reference.q_eci_body.conjugate();
  std::array<Transform::Vector, Transform::kPoints> moved;
  for (std::size_t k = 0; k < Transform::kPoints; ++k) {
    if (transform.is_mean(k)) {
      moved[k] = moved[0];
      continue;
    }
    x = transform.point(k);
    filter::AttitudeState sample;
    sample.q_eci_body = attitude_.q_eci_body * filter::quaternion_of_grp(x.head<3>());
    sample.rate_body = x.segment<3>(3);
    const filter::AttitudeState later =
        filter::propagate_attitude(sample, inertia_with(x.tail<2>()), gradient, step.dt);
    moved[k] << filter::grp_of(to_reference * later.q_eci_body), later.rate_body, x.tail<2>();
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
  attitude_.q_eci_body = (attitude_.q_eci_body * filter::quaternion_of_grp(rotation)).normalized();
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
