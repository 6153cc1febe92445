#include "fsw/navigation/own_orbit.h"

#include "fsw/navigation/dynamics.h"

namespace vbar::fsw::navigation {
namespace {

constexpr double kGate = 36.0;  // 6 sigma, one degree of freedom
constexpr int kMaxRefused = 6;
constexpr double kStartSpeedSigma = 0.05;  // m/s, of a filtered GNSS orbit, conservative

}  // namespace

void OwnOrbit::begin(const orbit::CartesianState& state) {
  const double variance = settings_.position_sigma_m * settings_.position_sigma_m;
  for (int axis = 0; axis < 3; ++axis) {
    estimate_.reset(axis, state.position_eci(axis), variance);
    estimate_.reset(3 + axis, state.velocity_eci(axis), kStartSpeedSigma * kStartSpeedSigma);
  }
  started_ = true;
  refused_in_a_row_ = 0;
}

/// The covariance is propagated by the Jacobian of point mass and J2, from differences of 100 m and 0.1 m/s.
void OwnOrbit::advance(const Propagation& propagation, double dt) {
  if (!started_ || dt == 0.0) return;
  const orbit::CartesianState old = state();
  const orbit::CartesianState later = propagation.coast(old, dt);
  const orbit::CartesianState middle = propagate_accelerated(old, Vector3::Zero(), dt);
  Matrix6 jacobian;
  for (int k = 0; k < 6; ++k) {
    const double step = k < 3 ? 100.0 : 0.1;
    orbit::CartesianState shifted = old;
    if (k < 3) {
      shifted.position_eci(k) += step;
    } else {
      shifted.velocity_eci(k - 3) += step;
    }
    const orbit::CartesianState end = propagate_accelerated(shifted, Vector3::Zero(), dt);
    jacobian.col(k) << (end.position_eci - middle.position_eci) / step, (end.velocity_eci - middle.velocity_eci) / step;
  }
  Vector6 mean;
  mean << later.position_eci, later.velocity_eci;
  Matrix6 noise = Matrix6::Zero();
  add_acceleration_noise(noise, settings_.acceleration_psd, dt);
  estimate_.transform_head<6>(mean, jacobian, noise);
  if (!estimate_.is_sound()) reset();
}

void OwnOrbit::add_impulse(const Vector3& dv_eci, double sigma) {
  for (int axis = 0; axis < 3; ++axis) {
    estimate_.shift(3 + axis, dv_eci(axis));
    estimate_.add_noise(3 + axis, sigma * sigma);
  }
}

void OwnOrbit::take(const orbit::CartesianState& measured) {
  if (!started_) {
    begin(measured);
    return;
  }
  const double variance = settings_.position_sigma_m * settings_.position_sigma_m;
  for (int axis = 0; axis < 3; ++axis) {
    const double residual = measured.position_eci(axis) - estimate_.mean(axis);
    if (residual * residual <= kGate * (estimate_.variance(axis) + variance)) continue;
    if (++refused_in_a_row_ >= kMaxRefused) begin(measured);
    return;
  }
  refused_in_a_row_ = 0;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double kNoGate = 1e300;
    const double residual = measured.position_eci(axis) - estimate_.mean(axis);
    estimate_.update(Vector6::Unit(axis), residual, variance, kNoGate);
  }
}

}  // namespace vbar::fsw::navigation
