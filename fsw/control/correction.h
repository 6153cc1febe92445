#pragma once
// Small corrections to a plan that is being flown: the times stay, the burns change a little.

#include "fsw/control/arrival.h"
#include "fsw/control/plan.h"

namespace vbar::fsw::control {

/// Distance (m) in the servicer's RTN at the waypoint that an arrival error of dimensionless ROE amounts to; linear map.
Result<double> arrival_distance(const MeanOrbits& orbits, const Waypoint& waypoint, const Vector6& roe_error);

/// The plan with its burns changed by the least amount (radial parts counted three times as dear) that takes the predicted
/// arrival error out. `committed` burns, all earlier, fly as they are. Directions in which the burns can do next to nothing
/// are left alone: forcing them costs metres per second. The caller judges what is left. kNotReady for a plan without burns;
/// errors as arrival_error().
Result<Plan> correct_plan(const MeanOrbits& orbits, const Plan& committed, const Plan& plan, const Waypoint& waypoint);

}  // namespace vbar::fsw::control
