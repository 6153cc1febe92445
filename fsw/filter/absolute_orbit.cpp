#include "fsw/filter/absolute_orbit.h"

#include <algorithm>

#include "fsw/filter/propagation.h"
#include "fsw/math/cholesky.h"
#include "fsw/orbit/gravity_field.h"

namespace vbar::fsw::filter {
namespace {

constexpr int kSlowError = 6;
constexpr double kNoGate = 1e300;
// Interval of the two positions that initialise the orbit, s.
constexpr double kMinBaseline_s = 0.5;
constexpr double kMaxBaseline_s = 120.0;

constexpr double square(double x) {
  return x * x;
}

}  // namespace

void AbsoluteOrbitFilter::initialize(const orbit::CartesianState& state, double sigma_m, double sigma_mps) {
  for (int axis = 0; axis < 3; ++axis) {
    estimate_.reset(axis, state.position_eci(axis), square(sigma_m));
    estimate_.reset(3 + axis, state.velocity_eci(axis), square(sigma_mps));
    estimate_.reset(kSlowError + axis, 0.0, square(settings_.slow_error_sigma_m));
  }
  started_ = true;
  rejected_in_a_row_ = 0;
}

/// Velocity from two positions: the chord, corrected for the curvature due to the point mass.
void AbsoluteOrbitFilter::initialize_from_two(GpsTime time, const AbsolutePosition& measured) {
  const double baseline =
      first_.is_known ? seconds(time - first_.time) - measured.early_s + first_.position.early_s : 0.0;
  if (!first_.is_known || !(baseline >= 0.0) || baseline > kMaxBaseline_s) {
    first_ = {.is_known = true, .time = time, .position = measured};
    return;
  }
  if (baseline < kMinBaseline_s) return;
  const Vector3 middle = 0.5 * (first_.position.position_eci + measured.position_eci);
  const double distance = middle.norm();
  const Vector3 gravity = -orbit::kMu / (distance * distance * distance) * middle;
  const Vector3 velocity = (measured.position_eci - first_.position.position_eci) / baseline + 0.5 * baseline * gravity;
  const double noise_m = math::sqrt(measured.covariance_m2.trace() / 3.0);
  const double sigma_m = math::hypot(noise_m, settings_.slow_error_sigma_m);
  initialize({.position_eci = measured.position_eci + measured.early_s * velocity, .velocity_eci = velocity}, sigma_m,
             settings_.start_velocity_sigma + 2.0 * noise_m / baseline);
  first_.is_known = false;
}

bool AbsoluteOrbitFilter::process(GpsTime time, const AbsolutePosition& measured) {
  nis_ = 0.0;
  if (!started_) {
    initialize_from_two(time, measured);
    return true;
  }
  const Vector3 position = measured.position_eci + measured.early_s * state().velocity_eci;
  Matrix3 innovation = measured.covariance_m2;
  Vector3 residual;
  for (int r = 0; r < 3; ++r) {
    residual(r) = position(r) - estimate_.mean(r) - estimate_.mean(kSlowError + r);
    for (int c = 0; c < 3; ++c) {
      innovation(r, c) += estimate_.covariance(r, c) + estimate_.covariance(r, kSlowError + c) +
                          estimate_.covariance(kSlowError + r, c) +
                          estimate_.covariance(kSlowError + r, kSlowError + c);
    }
  }
  const math::Cholesky<3> joint(innovation);
  const math::Cholesky<3> noise(measured.covariance_m2);
  if (!noise.ok()) return false;
  nis_ = joint.ok() ? joint.solve_lower(residual).squaredNorm() : kNoGate;
  if (!(nis_ <= settings_.gate)) {
    if (++rejected_in_a_row_ < kMaxRejected) return false;
    widen(residual.norm());
    return process(time, measured);
  }
  rejected_in_a_row_ = 0;
  // Whitened, then one axis after the other.
  const Estimate::Vector old = estimate_.mean();
  const Vector3 whitened = noise.solve_lower(residual);
  Matrix3 rows;
  for (int c = 0; c < 3; ++c) rows.col(c) = noise.solve_lower(Vector3::Unit(c));
  for (int r = 0; r < 3; ++r) {
    Estimate::Vector h = Estimate::Vector::Zero();
    h.head<3>() = rows.row(r).transpose();
    h.segment<3>(kSlowError) = rows.row(r).transpose();
    estimate_.update(h, whitened(r) - h.dot(estimate_.mean() - old), 1.0, kNoGate);
  }
  if (!estimate_.is_sound()) fail();
  return true;
}

/// Persistent contradiction: the orbit stays, as after an unknown burn, so that what refers to it is propagated with
/// it.
void AbsoluteOrbitFilter::widen(double residual_m) {
  const double velocity_sigma = std::max(settings_.start_velocity_sigma, residual_m / kMaxBaseline_s);
  for (int axis = 0; axis < 3; ++axis) {
    estimate_.add_noise(axis, square(residual_m));
    estimate_.add_noise(3 + axis, square(velocity_sigma));
  }
  rejected_in_a_row_ = 0;
  ++inflations_;
}

void AbsoluteOrbitFilter::fail() {
  started_ = false;
  first_.is_known = false;
  rejected_in_a_row_ = 0;
}

/// The covariance is propagated by the Jacobian of point mass and J2, from differences of 100 m and 0.1 m/s.
void AbsoluteOrbitFilter::advance(const filter::Propagation& propagation, double dt, const filter::Thrust& thrust) {
  if (!started_ || dt == 0.0) return;
  const orbit::CartesianState old = state();
  const orbit::CartesianState later = propagation.coast(old, dt, {.empirical_rtn = thrust.acceleration_rtn});
  const orbit::CartesianState middle = filter::propagate_accelerated(old, thrust.acceleration_rtn, dt);
  const double decay = math::exp(-dt / settings_.slow_error_time_s);
  Estimate::Matrix jacobian = Estimate::Matrix::Zero();
  Estimate::Vector mean;
  mean << later.position_eci, later.velocity_eci, decay * estimate_.mean().tail<3>();
  for (int k = 0; k < 6; ++k) {
    const double step = k < 3 ? 100.0 : 0.1;
    orbit::CartesianState shifted = old;
    if (k < 3) {
      shifted.position_eci(k) += step;
    } else {
      shifted.velocity_eci(k - 3) += step;
    }
    const orbit::CartesianState end = filter::propagate_accelerated(shifted, thrust.acceleration_rtn, dt);
    jacobian.col(k).head<6>() << (end.position_eci - middle.position_eci) / step,
        (end.velocity_eci - middle.velocity_eci) / step;
  }
  Estimate::Matrix noise = Estimate::Matrix::Zero();
  filter::add_acceleration_noise(noise, settings_.acceleration_psd + thrust.psd, dt);
  for (int axis = 0; axis < 3; ++axis) {
    jacobian(kSlowError + axis, kSlowError + axis) = decay;
    noise(kSlowError + axis, kSlowError + axis) = square(settings_.slow_error_sigma_m) * (1.0 - square(decay));
  }
  estimate_.transform_head<9>(mean, jacobian, noise);
  if (!estimate_.is_sound()) fail();
}

void AbsoluteOrbitFilter::add_impulse(const Vector3& dv_eci, double sigma) {
  if (!started_) return;
  for (int axis = 0; axis < 3; ++axis) {
    estimate_.shift(3 + axis, dv_eci(axis));
    estimate_.add_noise(3 + axis, square(sigma));
  }
}

}  // namespace vbar::fsw::filter
