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

// The attitude of one spacecraft over time, whether it follows from torques (RigidBody) or from a pointing profile
// (PointingProfile). The orbit is given and does not depend on the attitude.

/// Attitude over time. Times are seconds after the model's epoch. Not thread-safe: one thread per spacecraft.
class AttitudeMotion {
 public:
  AttitudeMotion() = default;
  AttitudeMotion(const AttitudeMotion&) = delete;
  AttitudeMotion& operator=(const AttitudeMotion&) = delete;
  virtual ~AttitudeMotion() = default;

  /// Computes the attitude up to `seconds`, not before the time of the last call. `orbit_step_end` (>= seconds) is
  /// where the spacecraft's current orbit integration step ends: beyond it the orbit is not known yet. To be called at
  /// least once in each of these steps.
  virtual void advance_to(double seconds, double orbit_step_end) = 0;

  /// Accounts for an impulse that has changed the orbit from `seconds` on, the time of the last advance_to.
  virtual void orbit_changed(double seconds) = 0;

  /// Returns the attitude at a time for which both the attitude and the orbit are kept. Throws std::out_of_range
  /// outside, stating what is kept; std::domain_error if the attitude is not defined there.
  [[nodiscard]] virtual AttitudeState state_at(double seconds) const = 0;
};

}  // namespace vbar::truth
