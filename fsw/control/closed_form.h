#pragma once
// The closed-form impulsive solver for near-circular orbits (Chernick and D'Amico 2018; Chernick 2021): tangential
// impulses half orbits apart at the phase of the desired eccentricity change, one normal impulse at that of the
// inclination change.
//
// Beyond the published scheme: if three impulses on the phase grid miss the reachable lower bound, a linear program
// over the grid and half orbits from both ends of the window finds four; the normal impulse is distributed over the
// tangential ones, so that |T| and |N| add in quadrature; and the coupling by J2 and eccentricity is iterated away.

#include "fsw/control/plan.h"
#include "fsw/packets/message_traits.h"

namespace vbar::fsw::control {

struct ClosedFormSettings {
  /// Smallest eccentricity change (m, a |de|) with a defined phase; below it, burns may be at any time.
  double eccentricity_floor_m = 1.0;
  /// Interval (s) within which a tangential burn moves to the time of a normal one; R components then correct the
  /// eccentricity vector.
  double merge_window = 120.0;
  /// Interval (s) before arrival without burns.
  double final_coast = 0.0;
};

/// Returns burns (of the servicer, signs as in Plan) that achieve the pseudo-state to a relative error of 1e-6 in the
/// linear model with the exact effects of the burns. Errors of check_problem(); kInvalidArgument for an empty window;
/// kSingular when the window has fewer than three burn times or only one parity of them (shorter than about an orbit):
/// the next solver is used; kDidNotConverge if the coupling iteration does not converge.
Result<Plan> solve_closed_form(const ControlProblem& problem, const ClosedFormSettings& settings = {});

/// The entry of the solver list (solver_list.h).
struct ClosedForm {
  static constexpr Solver kId{waypoint::kSolverClosedForm};
  static constexpr const char* kName = "closed_form";
  static constexpr const char* kDescription =
      "the closed-form solver for near-circular orbits (Chernick and D'Amico 2018)";
  /// Largest mean eccentricity: beyond it terms of the order of the eccentricity, which are removed by iteration,
  /// dominate.
  static constexpr double kMaxEccentricity = 0.06;
  static constexpr auto kStatus = &telemetry_control::closed_form_status;

  using Settings = ClosedFormSettings;
  struct Workspace {};
  static Settings settings(const gnc_configuration& /*configuration*/, const ThrustWindows& /*windows*/) { return {}; }
  static Result<Plan> solve(const ControlProblem& problem, const Settings& settings, Workspace& /*workspace*/) {
    return solve_closed_form(problem, settings);
  }
};

}  // namespace vbar::fsw::control
