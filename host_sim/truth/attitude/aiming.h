#pragma once
// Attitude from two directions: a primary one, which a body axis follows, and a secondary one, which fixes the rotation
// about that axis; and the angular rate, from the rates of the directions: exact, without finite differences.

#include "fsw/core/types.h"
#include "host_sim/truth/attitude/attitude_state.h"

namespace vbar::truth {

/// A direction in ECI and its time derivative. Need not be a unit vector; any unit of length.
struct MovingDirection {
  fsw::Vector3 along = fsw::Vector3::Zero();
  fsw::Vector3 rate = fsw::Vector3::Zero();
};

/// Aligns body axis `boresight_body` exactly with `primary` and, with the remaining freedom, `second_body` as closely
/// as possible with `secondary` (both body axes of any length, not parallel). Within kLeastAngle_rad of parallel or
/// antiparallel the secondary does not fix the rotation about the boresight: throws std::domain_error, as it does for
/// directions that are zero or not finite. Towards that limit the rate about the boresight grows as 1 / angle.
AttitudeState aimed_attitude(const fsw::Vector3& boresight_body, const fsw::Vector3& second_body,
                             const MovingDirection& primary, const MovingDirection& secondary);

/// An arcsecond: the triad's third axis then still has ten correct digits.
inline constexpr double kLeastAngle_rad = 5e-6;

}  // namespace vbar::truth
