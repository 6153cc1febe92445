#include "fsw/filter/relative_orbit.h"

#include <array>

#include "fsw/estimation/unscented.h"
#include "fsw/orbit/rtn.h"

namespace vbar::fsw::filter {
namespace {

constexpr int kDrag = kAt<DifferentialAccelerations>;
constexpr int kFromSun = kDrag + 1;
constexpr int kEmpirical = kAt<EmpiricalAcceleration>;

constexpr double square(double x) {
  return x * x;
}

}  // namespace

void add_velocity_noise(const orbit::QnsElements& servicer, double psd, double dt, Matrix6& noise) {
  constexpr std::array<double, 3> kAtShare = {0.1127016653792583, 0.5, 0.8872983346207417};
  constexpr std::array<double, 3> kWeight = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const double n = orbit::mean_motion(servicer.a);
  for (std::size_t k = 0; k < 3; ++k) {
    orbit::QnsElements then = servicer;
    then.u += n * kAtShare[k] * dt;
    Matrix63 gamma = orbit::roe_control_matrix_near_circular(then);
    gamma.row(1) -= 1.5 * n * (1.0 - kAtShare[k]) * dt * gamma.row(0);
    const double weight = kWeight[k] * dt * psd;
    noise += (weight * gamma).lazyProduct(gamma.transpose());
  }
}

void RelativeOrbit::configure(const RelativeOrbitSettings& settings) {
  if (!(settings.acceleration == settings_.acceleration)) noise_ = filter::AdaptiveNoise(settings.acceleration);
  settings_ = settings;
}

void RelativeOrbit::initialize(Estimate& estimate, const Vector6& roe, const Matrix6& covariance) {
  for (int k = 0; k < Roe::kSize; ++k) estimate.reset(k, 0.0, 0.0);
  estimate.transform_head<Roe::kSize>(roe, Matrix6::Identity(), covariance);
  initialize_process(estimate, kDrag, settings_.drag);
  initialize_process(estimate, kFromSun, settings_.from_sun);
  noise_.interrupt();
}

void RelativeOrbit::deactivate(Estimate& estimate) const {
  deactivate_block<EmpiricalAcceleration>(estimate);
  deactivate_block<DifferentialAccelerations>(estimate);
  deactivate_block<Roe>(estimate);
}

void RelativeOrbit::activate_empirical(Estimate& estimate) const {
  if (!is_active<EmpiricalAcceleration>(estimate))
    initialize_block<EmpiricalAcceleration>(estimate, settings_.empirical);
}

bool RelativeOrbit::advance(const Estimate& estimate, const OrbitStep& step, HeadMotion& motion) const {
  using Transform = estimation::UnscentedTransform<kOrbitSize>;
  using Sampled = Transform::Vector;
  Transform transform;
  const auto before = orbit::qns_from_cartesian(step.servicer);
  const auto after = orbit::qns_from_cartesian(
      step.propagation.coast(step.servicer, step.dt, {.empirical_rtn = step.thrust.acceleration_rtn}));
  if (!before.ok() || !after.ok() ||
      transform.start(estimate.mean().head<kOrbitSize>(), estimate.head_covariance<kOrbitSize>()) != Status::kOk) {
    return false;
  }
  const double drag_decay = settings_.drag.decay(step.dt);
  const double from_sun_decay = settings_.from_sun.decay(step.dt);
  const double empirical_decay = settings_.empirical.decay(step.dt);
  std::array<Sampled, Transform::kPoints> moved;
  for (std::size_t k = 0; k < Transform::kPoints; ++k) {
    if (transform.is_mean(k)) {
      moved[k] = moved[0];
      continue;
    }
    const Sampled x = transform.point(k);
    const auto target = target_from_roe(before.value(), x.head<6>());
    if (!target.ok()) return false;
    const filter::DifferentialAcceleration differential{
        .drag = x(kDrag), .from_sun = x(kFromSun), .empirical_rtn = x.segment<3>(kEmpirical)};
    const auto deputy = orbit::qns_from_cartesian(step.propagation.coast(target.value(), step.dt, differential));
    if (!deputy.ok()) return false;
    moved[k] << orbit::roe_from_qns(after.value(), deputy.value()), drag_decay * x(kDrag), from_sun_decay * x(kFromSun),
        empirical_decay * x.segment<3>(kEmpirical);
  }
  const auto regression = transform.regress<kOrbitSize>(moved);
  motion.mean.head<kOrbitSize>() = regression.mean;
  motion.jacobian.topLeftCorner<kOrbitSize, kOrbitSize>() = regression.jacobian;
  motion.noise.topLeftCorner<kOrbitSize, kOrbitSize>() = regression.nonlinearity;
  motion.noise(kDrag, kDrag) += settings_.drag.renewed_variance(drag_decay);
  motion.noise(kFromSun, kFromSun) += settings_.from_sun.renewed_variance(from_sun_decay);
  if (is_active<EmpiricalAcceleration>(estimate)) {
    for (int axis = 0; axis < 3; ++axis) {
      motion.noise(kEmpirical + axis, kEmpirical + axis) += settings_.empirical.renewed_variance(empirical_decay);
    }
  } else {
    // White noise stands for the same effects.
    Matrix6 noise = motion.noise.topLeftCorner<6, 6>();
    add_velocity_noise(before.value(), noise_.psd(), step.dt, noise);
    motion.noise.topLeftCorner<6, 6>() = noise;
  }
  if (step.thrust.is_on) {
    Matrix6 noise = motion.noise.topLeftCorner<6, 6>();
    add_velocity_noise(before.value(), step.thrust.psd, step.dt, noise);
    motion.noise.topLeftCorner<6, 6>() = noise;
  }
  return true;
}

bool RelativeOrbit::impulse(Estimate& estimate, const orbit::CartesianState& servicer, const Vector3& dv_eci,
                            double sigma) {
  using Transform = estimation::UnscentedTransform<6>;
  Transform transform;
  const auto before = orbit::qns_from_cartesian(servicer);
  const auto after = orbit::qns_from_cartesian({servicer.position_eci, servicer.velocity_eci + dv_eci});
  if (!before.ok() || !after.ok()) return false;
  const Vector6 roe = estimate.mean().head<6>();
  if (transform.start(roe, estimate.head_covariance<6>()) != Status::kOk) return false;
  std::array<Vector6, Transform::kPoints> moved;
  for (std::size_t k = 0; k < Transform::kPoints; ++k) {
    moved[k] = orbit::roe_from_qns(after.value(), orbit::qns_from_roe(before.value(), transform.point(k)));
  }
  const auto regression = transform.regress<6>(moved);
  const Matrix63 gamma = orbit::roe_control_matrix(before.value());
  const Matrix6 noise = regression.nonlinearity + (square(sigma) * gamma).lazyProduct(gamma.transpose());
  estimate.transform_head<6>(regression.mean, regression.jacobian, noise);
  noise_.interrupt();
  return true;
}

void RelativeOrbit::inflate(Estimate& estimate, const orbit::CartesianState& servicer, double velocity_sigma,
                            double longitude_sigma) {
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok()) return;
  const Matrix63 gamma = orbit::roe_control_matrix(chief.value());
  Matrix6 noise = (square(velocity_sigma) * gamma).lazyProduct(gamma.transpose());
  noise(1, 1) += square(longitude_sigma);
  const Vector6 roe = estimate.mean().head<6>();
  estimate.transform_head<6>(roe, Matrix6::Identity(), noise);
  noise_.interrupt();
}

void RelativeOrbit::inflate_by_burn(Estimate& estimate, const orbit::CartesianState& servicer, double velocity_sigma,
                                    double dt) {
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok() || !(dt > 0.0)) return;
  orbit::QnsElements before = chief.value();
  before.u -= orbit::mean_motion(before.a) * dt;
  Matrix6 noise = Matrix6::Zero();
  add_velocity_noise(before, square(velocity_sigma) / dt, dt, noise);
  const Vector6 roe = estimate.mean().head<6>();
  estimate.transform_head<6>(roe, Matrix6::Identity(), noise);
  noise_.interrupt();
}

Matrix6 covariance_rtn(const Vector6& roe, const Matrix6& covariance, const orbit::CartesianState& servicer) {
  constexpr double kDifferenceStep = 1e-7;
  const auto chief = orbit::qns_from_cartesian(servicer);
  if (!chief.ok()) return Matrix6::Zero();
  Matrix6 jacobian;
  for (int k = 0; k < 6; ++k) {
    const auto plus = target_from_roe(chief.value(), roe + kDifferenceStep * Vector6::Unit(k));
    const auto minus = target_from_roe(chief.value(), roe - kDifferenceStep * Vector6::Unit(k));
    if (!plus.ok() || !minus.ok()) return Matrix6::Zero();
    const auto a = orbit::relative_state_rtn(servicer, plus.value());
    const auto b = orbit::relative_state_rtn(servicer, minus.value());
    jacobian.col(k) << (a.position_rtn - b.position_rtn) / (2.0 * kDifferenceStep),
        (a.velocity_rtn - b.velocity_rtn) / (2.0 * kDifferenceStep);
  }
  return jacobian.lazyProduct(covariance).lazyProduct(jacobian.transpose());
}

Matrix6 covariance_rtn(const Estimate& estimate, const orbit::CartesianState& servicer) {
  if (!is_active<Roe>(estimate)) return Matrix6::Zero();
  return covariance_rtn(estimate.mean().head<6>(), estimate.head_covariance<6>(), servicer);
}

}  // namespace vbar::fsw::filter
