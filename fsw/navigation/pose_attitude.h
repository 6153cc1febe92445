#pragma once
// Attitude motion of the target: a rigid body of known inertia with gravity-gradient torque, and small rotations as
// generalised Rodrigues parameters.

#include <Eigen/Geometry>

#include "fsw/core/result.h"
#include "fsw/core/types.h"

namespace vbar::fsw::navigation {

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

}  // namespace vbar::fsw::navigation
