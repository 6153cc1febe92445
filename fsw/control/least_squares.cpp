#include "fsw/control/least_squares.h"
namespace vbar::fsw::control {
Result<Plan> solve_least_squares(const ControlProblem&) { return Status::kNotReady; }
}
