#pragma once
// Attitude from two directions: one that a body axis must meet, one that a second axis comes as near to as it can. And
// the rate that belongs to it, from the directions' own rates: exact, nothing is differenced.

#include "fsw/core/types.h"
#include "host_sim/truth/attitude/attitude_state.h"

namespace vbar::truth {

/// A direction in ECI and its time derivative. Need not be a unit vector; any unit of length.
struct MovingDirection {
  fsw::Vector3 along = fsw::Vector3::Zero();
  fsw::Vector3 rate = fsw::Vector3::Zero();
};

/// Turns body axis `boresight_body` exactly along `primary` and, with the freedom left, `second_body` as near as
/// possible to `secondary` (both body axes of any length, not parallel). Within kLeastAngle_rad of parallel or
/// antiparallel the secondary says nothing about the turn about the boresight: throws std::domain_error, as it does for
/// directions that are zero or not finite. Towards that limit the rate about the boresight grows as 1 / angle.
AttitudeState aimed_attitude(const fsw::Vector3& boresight_body, const fsw::Vector3& second_body,
                             const MovingDirection& primary, const MovingDirection& secondary);

/// An arcsecond: the triad's third axis then still has ten correct digits.
inline constexpr double kLeastAngle_rad = 5e-6;

}  // namespace vbar::truth
