#pragma once
// Checks that every solver applies before it starts.

#include "fsw/control/plan.h"

namespace vbar::fsw::control {

/// Returns kOk if the problem is in the domain of the maps of mean ROE: 0 <= e < 0.9, sin i > 1e-6, perigee above the
/// ground, arrival at or after the start and at most 30 days later; else kOutOfRange. kNotFinite for a NaN or an
/// infinity.
Status check_problem(const ControlProblem& problem);

}  // namespace vbar::fsw::control
