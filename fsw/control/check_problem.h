#pragma once
// What every solver refuses before it starts.

#include "fsw/control/plan.h"

namespace vbar::fsw::control {

/// kOk if the problem is within what the maps of mean ROE are valid for: 0 <= e < 0.9, sin i > 1e-6, perigee above the
/// ground, arrival at or after the start and at most 30 days later; else kOutOfRange. kNotFinite for a NaN or an
/// infinity.
Status check_problem(const ControlProblem& problem);

}  // namespace vbar::fsw::control
