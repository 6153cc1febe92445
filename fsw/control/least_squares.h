#pragma once
#include "fsw/control/plan.h"
namespace vbar::fsw::control {
Result<Plan> solve_least_squares(const ControlProblem& problem);
}
