#pragma once
// From the multipliers of the primer program to a small number of exact impulses.

#include <array>
#include <cstddef>

#include "fsw/control/primer_program.h"

namespace vbar::fsw::control {

/// Reduces the program's impulses in place to at most six with the same sum G u and no greater cost (Caratheodory),
/// then drops those below `prune_ratio` of the largest and joins those at neighbouring times, where the others can make
/// compensate it and the cost stays below `cost_limit`; finally reaches the target to rounding. `program.count` is the
/// number left.
void extract_impulses(PrimerProgram& program, double prune_ratio, double cost_limit);

/// |target - sum G u|.
double impulse_residual(const PrimerProgram& program);

}  // namespace vbar::fsw::control
