#pragma once
// Propagation of the filters: point mass and J2, with a constant acceleration in the spacecraft's own RTN.

#include <Eigen/Core>

#include "fsw/orbit/elements.h"

namespace vbar::fsw::filter {

/// The state `dt` (s, either sign, at most an hour) later; `acceleration_rtn` (m/s^2) rotates with the orbit.
/// Classical Runge-Kutta 4, steps of at most 10 s: truncation below a micrometre per step. The caller guarantees finite
/// input.
orbit::CartesianState propagate_accelerated(const orbit::CartesianState& state, const Vector3& acceleration_rtn,
                                            double dt);

/// Adds the process noise of a white acceleration (power spectral density, m^2/s^3, per axis) over `dt` seconds to the
/// covariance of a state that begins with position and velocity: that of a double integrator.
template <int N>
void add_acceleration_noise(Eigen::Matrix<double, N, N>& covariance, double psd, double dt) {
  for (int axis = 0; axis < 3; ++axis) {
    covariance(axis, axis) += psd * dt * dt * dt / 3.0;
    covariance(axis, 3 + axis) += psd * dt * dt / 2.0;
    covariance(3 + axis, axis) += psd * dt * dt / 2.0;
    covariance(3 + axis, 3 + axis) += psd * dt;
  }
}

}  // namespace vbar::fsw::filter
