#pragma once
// Arrival error of a plan: mean ROE at the time of the waypoint, predicted from the two absolute mean orbits.
//
// The linear state transition misses the waypoint by tens of metres at 75 km (second-order terms in the separation, and
// the servicer's own orbit changes with its burns). Two absolute orbits, each with its own secular rates, and burns
// applied to the servicer's osculating state leave decimetres over six hours; feedback removes those.

#include <span>

#include "fsw/control/plan.h"

namespace vbar::fsw::control {

/// Holds the desired relative orbit of the target at a time. Metres of a waypoint table are made dimensionless by
/// one fixed semi-major axis for the whole mission: by the current one, a waypoint at 50 km would move by 14 m.
struct Waypoint {
  GpsTime time;
  Vector6 roe = Vector6::Zero();  ///< mean ROE, dimensionless
};

/// Holds the mean elements of both spacecraft at one instant.
struct MeanOrbits {
  GpsTime epoch;
  orbit::QnsElements servicer;
  orbit::QnsElements target;
};

/// Returns the mean elements after an impulse dv (m/s, own RTN frame): through the osculating state, where the impulse
/// acts. Errors of the element conversions; kOutOfRange if the impulse moves the orbit by more than about 1e-2 of
/// itself.
Result<orbit::QnsElements> mean_after_impulse(const orbit::QnsElements& mean, const Vector3& dv_rtn);

/// Returns both orbits at `until` if the servicer flies `burns` on the way. kInvalidArgument unless the burns are in
/// order of time and within [orbits.epoch, until].
Result<MeanOrbits> fly(const MeanOrbits& orbits, std::span<const Burn> burns, GpsTime until);

/// Returns the desired mean ROE (dimensionless) at the waypoint minus those at which `burns` arrive. A burn at the
/// waypoint's own time counts: the ROE, unlike the position, change at once. Errors as fly().
Result<Vector6> arrival_error(const MeanOrbits& orbits, std::span<const Burn> burns, const Waypoint& waypoint);

/// Returns the remaining problem from `start` on if `committed`, all before `start`, is flown: the pseudo-state is the
/// arrival error of the free drift after those. kInvalidArgument if the waypoint does not lie after `start`; else
/// errors as fly().
Result<ControlProblem> remaining_problem(const MeanOrbits& orbits, std::span<const Burn> committed, GpsTime start,
                                         const Waypoint& waypoint);

/// Returns the 6x3 linear change of the ROE at `arrival` per impulse (m/s, RTN) of the DEPUTY at `burn`:
/// Phi(arrival - burn) Gamma(burn). `servicer_mean` holds at `epoch`; the servicer's own burns in between are
/// neglected. Negate for the servicer.
Matrix63 arrival_effect(const orbit::QnsElements& servicer_mean, GpsTime epoch, GpsTime burn, GpsTime arrival);

}  // namespace vbar::fsw::control
