#pragma once
// Attitude and angular rate of a body at one instant.

#include <Eigen/Geometry>

#include "fsw/core/types.h"

namespace vbar::truth {

struct AttitudeState {
  /// Unit quaternion: q_body_eci * v_eci is v in body axes. ECI is GCRF.
  Eigen::Quaterniond q_body_eci = Eigen::Quaterniond::Identity();
  /// Angular rate of the body with respect to ECI, in body axes, rad/s.
  fsw::Vector3 rate_body = fsw::Vector3::Zero();
};

/// Returns the angle of the rotation that takes one attitude to the other, rad, 0 to pi; precise for small angles too.
inline double angle_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return a.angularDistance(b);
}

}  // namespace vbar::truth
