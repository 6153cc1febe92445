#pragma once
// Block of the target's attitude: a rigid body under gravity gradient, as a small rotation about a reference quaternion
// (USQUE, Crassidis and Markley 2003), its rate, and two ratios of its inertia.

#include "fsw/navigation/adaptive_noise.h"
#include "fsw/navigation/pose_attitude.h"
#include "fsw/trunk/relative_orbit.h"

namespace vbar::fsw::filter {

struct TargetAttitudeSettings {
  navigation::Inertia inertia;  ///< only its ratios matter
  /// rad^2/s^3. The least is that of a torque of 7e-7 N m on 3 kg m^2 (the Earth's magnetic field on a dipole of
  /// 0.02 A m^2) whose direction in body axes changes within a minute. With a fifth of it, the NEES of attitude and
  /// rate (6 expected) was 24 to 43 for more than an hour of one of two flights.
  navigation::AdaptiveNoiseSettings angular_acceleration{.psd = 1e-11, .psd_min = 5e-12, .psd_max = 1e-10};
  double inertia_ratio_sigma = 0.02;  ///< sigma of the logarithms of the ratios, once they are activated
};

class TargetAttitude {
 public:
  /// Replaces the settings; the estimate stays, and the adapted process noise if the noise settings do.
  void configure(const TargetAttitudeSettings& settings);

  /// Initialises attitude and rate; covariance of the rotation in body axes (rad) and the rate (rad/s). Correlations
  /// with all other blocks end.
  void initialize(Estimate& estimate, const navigation::AttitudeState& attitude, const Matrix6& covariance);
  void deactivate(Estimate& estimate) const;
  [[nodiscard]] static bool is_known(const Estimate& estimate) { return is_active<Turn>(estimate); }
  /// Activates the inertia ratios, for a target observed over an hour and more.
  void activate_inertia_ratios(Estimate& estimate) const;

  /// Propagates by sigma points; false if the covariance is not positive definite.
  [[nodiscard]] bool advance(const Estimate& estimate, const OrbitStep& step, HeadMotion& motion);

  /// Moves the estimated rotation into the reference quaternion, after every change of the estimate.
  void reset_attitude_error(Estimate& estimate);

  [[nodiscard]] const navigation::AttitudeState& state() const { return attitude_; }
  [[nodiscard]] const navigation::Inertia& inertia() const { return settings_.inertia; }
  [[nodiscard]] navigation::AdaptiveNoise& noise() { return noise_; }
  [[nodiscard]] const navigation::AdaptiveNoise& noise() const { return noise_; }

 private:
  [[nodiscard]] navigation::Inertia inertia_with(const Vector2& log_ratios) const;

  TargetAttitudeSettings settings_;
  navigation::AdaptiveNoise noise_{TargetAttitudeSettings{}.angular_acceleration};
  navigation::AttitudeState attitude_;  ///< the reference, and the estimated rate
};

/// Covariance of the rotation in body axes (rad) and the rate (rad/s).
Matrix6 attitude_covariance(const Estimate& estimate);
/// 1 sigma of the body axis with the largest uncertainty, rad.
double attitude_sigma(const Estimate& estimate);

}  // namespace vbar::fsw::filter
