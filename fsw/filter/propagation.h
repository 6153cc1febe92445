#pragma once
// Propagation of the filters. Between measurements, both spacecraft under the same gravity of degree 20, so that the
// neglected terms nearly cancel in the relative motion; differential accelerations act on the target in addition. Over
// the duration of a burn, point mass and J2 with a constant acceleration in the spacecraft's own RTN.

#include <Eigen/Core>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/orbit/earth_rotation.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::filter {

/// Acceleration of a spacecraft relative to that of the other, m/s^2.
struct DifferentialAcceleration {
  double drag = 0.0;                        ///< along its velocity through air that rotates with the Earth
  double from_sun = 0.0;                    ///< away from the Sun, while in sunlight: radiation pressure
  Vector3 empirical_rtn = Vector3::Zero();  ///< in its own RTN
};

/// Propagations from one instant: the Earth's orientation is computed once for all spacecraft and sigma points.
class Propagation {
 public:
  /// `sun_eci`: unit vector to the Sun, constant over a propagation.
  Propagation(GpsTime start, const orbit::EarthOrientation& earth, const Vector3& sun_eci);

  /// The state `dt` seconds (either sign, at most kLongest) after the start. Classical Runge-Kutta 4, steps of at most
  /// 20 s: error 0.25 m per orbit, and a hundredth of that between two spacecraft 75 km apart. Beyond kLongest
  /// it stops there. The caller guarantees finite input.
  [[nodiscard]] orbit::CartesianState coast(const orbit::CartesianState& state, double dt,
                                            const DifferentialAcceleration& differential = {}) const;

  static constexpr double kLongest = 7200.0;

 private:
  [[nodiscard]] Vector3 acceleration(const orbit::CartesianState& state, double after,
                                     const DifferentialAcceleration& differential) const;

  /// Velocity relative to the air, m/s.
  [[nodiscard]] Vector3 through_air(const orbit::CartesianState& state) const;

  Matrix3 R_itrf_gcrf_;  ///< at the start
  Vector3 sun_eci_;
};

/// Whether the position is outside the Earth's cylindrical shadow. `position_eci` in m, `sun_eci` a unit vector.
bool is_sunlit(const Vector3& position_eci, const Vector3& sun_eci);

/// The state `dt` (s, either sign, at most an hour) later under point mass and J2; `acceleration_rtn` (m/s^2) rotates
/// with the orbit. Classical Runge-Kutta 4, steps of at most 10 s: truncation below a micrometre per step. The caller
/// guarantees finite input.
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
