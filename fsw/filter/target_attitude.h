#pragma once
// Block of the target's attitude: a rigid body under gravity gradient, as a small rotation about a reference quaternion
// (USQUE, Crassidis and Markley 2003), its rate, and two ratios of its inertia.

#include <Eigen/Geometry>

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/filter/adaptive_noise.h"
#include "fsw/filter/relative_orbit.h"

namespace vbar::fsw::filter {

// Attitude motion of the target: a rigid body of known inertia with gravity-gradient torque, and small rotations as
// generalised Rodrigues parameters.

struct AttitudeState {
  Eigen::Quaterniond q_eci_body = Eigen::Quaterniond::Identity();
  Vector3 rate_body = Vector3::Zero();  ///< rad/s, of the body against ECI, in its own axes
};

/// A tensor of inertia (kg m^2, body axes, about the centre of mass) with its inverse.
struct Inertia {
  Matrix3 tensor = Matrix3::Identity();
  Matrix3 inverse = Matrix3::Identity();
};

/// kOutOfRange unless the tensor is symmetric and positive definite; kNotFinite.
Result<Inertia> inertia_of(const Matrix3& tensor);

/// The Earth seen from the body: T = 3 mu / r^3 u x J u (Wertz 1978, eq. 17-32), u to the centre or away from it.
struct GravityGradient {
  Vector3 vertical_eci = Vector3::UnitZ();
  double strength = 0.0;  ///< 3 mu / r^3, 1/s^2; 0: no torque
};

GravityGradient gravity_gradient_at(const Vector3& position_eci);

/// The attitude `dt` seconds (either sign, at most an hour) later. Euler's equations by classical Runge-Kutta 4, steps
/// of at most 2.5 s: 1e-6 rad per minute at 3 deg/s. The vertical is constant meanwhile, so use a minute at most.
AttitudeState propagate_attitude(const AttitudeState& state, const Inertia& inertia, const GravityGradient& gradient,
                                 double dt);

/// Generalised Rodrigues parameters with a = 1, f = 4 (Crassidis, Markley 2003): four times the modified ones, the
/// rotation vector if small. The quaternion has unit length; it is interpreted as the shorter of its two rotations.
Vector3 grp_of(const Eigen::Quaterniond& q);
Eigen::Quaterniond quaternion_of_grp(const Vector3& grp);

/// Rotation vector of a rotation matrix or unit quaternion, rad, at most pi long; and the quaternion of one.
Vector3 rotation_vector_of(const Eigen::Quaterniond& q);
Eigen::Quaterniond quaternion_of_rotation_vector(const Vector3& rotation);

struct TargetAttitudeSettings {
  filter::Inertia inertia;  ///< only its ratios matter
  /// rad^2/s^3. The least is that of a torque of 7e-7 N m on 3 kg m^2 (the Earth's magnetic field on a dipole of
  /// 0.02 A m^2) whose direction in body axes changes within a minute. With a fifth of it, the NEES of attitude and
  /// rate (6 expected) was 24 to 43 for more than an hour of one of two flights.
  filter::AdaptiveNoiseSettings angular_acceleration{.psd = 1e-11, .psd_min = 5e-12, .psd_max = 1e-10};
  double inertia_ratio_sigma = 0.02;  ///< sigma of the logarithms of the ratios, once they are activated
};

class TargetAttitude {
 public:
  /// Replaces the settings; the estimate stays, and the adapted process noise if the noise settings do.
  void configure(const TargetAttitudeSettings& settings);

  /// Initialises attitude and rate; covariance of the rotation in body axes (rad) and the rate (rad/s). Correlations
  /// with all other blocks end.
  void initialize(Estimate& estimate, const filter::AttitudeState& attitude, const Matrix6& covariance);
  void deactivate(Estimate& estimate) const;
  [[nodiscard]] static bool is_known(const Estimate& estimate) { return is_active<AttitudeError>(estimate); }
  /// Activates the inertia ratios, for a target observed over an hour and more.
  void activate_inertia_ratios(Estimate& estimate) const;

  /// Propagates by sigma points; false if the covariance is not positive definite.
  [[nodiscard]] bool advance(const Estimate& estimate, const OrbitStep& step, HeadMotion& motion);

  /// Moves the estimated rotation into the reference quaternion, after every change of the estimate.
  void reset_attitude_error(Estimate& estimate);

  [[nodiscard]] const filter::AttitudeState& state() const { return attitude_; }
  [[nodiscard]] const filter::Inertia& inertia() const { return settings_.inertia; }
  [[nodiscard]] filter::AdaptiveNoise& noise() { return noise_; }
  [[nodiscard]] const filter::AdaptiveNoise& noise() const { return noise_; }

 private:
  [[nodiscard]] filter::Inertia inertia_with(const Vector2& log_ratios) const;

  TargetAttitudeSettings settings_;
  filter::AdaptiveNoise noise_{TargetAttitudeSettings{}.angular_acceleration};
  filter::AttitudeState attitude_;  ///< the reference, and the estimated rate
};

/// Covariance of the rotation in body axes (rad) and the rate (rad/s).
Matrix6 attitude_covariance(const Estimate& estimate);
/// 1 sigma of the body axis with the largest uncertainty, rad.
double attitude_sigma(const Estimate& estimate);

}  // namespace vbar::fsw::filter
