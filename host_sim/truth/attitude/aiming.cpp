#include "host_sim/truth/attitude/aiming.h"

#include <stdexcept>

#include <Eigen/Geometry>

namespace vbar::truth {
namespace {

using fsw::Matrix3;
using fsw::Vector3;

/// Orthonormal axes in the columns: the first along `first`, the third across both, the second nearest to `second`.
Matrix3 axes_of(const Vector3& first, const Vector3& second) {
  Matrix3 axes;
  axes.col(0) = first.normalized();
  axes.col(2) = axes.col(0).cross(second).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

/// Derivative of v / |v|.
Vector3 unit_rate(const Vector3& v, const Vector3& rate) {
  const Vector3 unit = v.normalized();
  return (rate - unit * unit.dot(rate)) / v.norm();
}

}  // namespace

AttitudeState aimed_attitude(const Vector3& boresight_body, const Vector3& second_body, const MovingDirection& primary,
                             const MovingDirection& secondary) {
  const Vector3 across = primary.along.cross(secondary.along);
  // Written so that a NaN is rejected as well.
  if (!(across.norm() > kLeastAngle_rad * primary.along.norm() * secondary.along.norm())) {
    throw std::domain_error("the boresight lies along the direction that should fix the rotation about it");
  }
  const Matrix3 axes_eci = axes_of(primary.along, secondary.along);
  const Matrix3 axes_body = axes_of(boresight_body, second_body);

  // Axes e1, e2, e3 that rotate at w have e1' e2 = w3, e3' e1 = w2, e3' e2 = -w1.
  const Vector3 across_rate = primary.rate.cross(secondary.along) + primary.along.cross(secondary.rate);
  const Vector3 e1_rate = unit_rate(primary.along, primary.rate);
  const Vector3 e3_rate = unit_rate(across, across_rate);
  const Vector3 rate_axes(-e3_rate.dot(axes_eci.col(1)), e3_rate.dot(axes_eci.col(0)), e1_rate.dot(axes_eci.col(1)));

  AttitudeState attitude;
  attitude.q_body_eci = Eigen::Quaterniond(Matrix3(axes_body * axes_eci.transpose())).normalized();
  attitude.rate_body = axes_body * rate_axes;
  return attitude;
}

}  // namespace vbar::truth
