#pragma once
// Fuel-optimal impulsive control of the relative orbit over a grid of candidate times: the primer-vector solver on the
// J2 dynamics of mean ROE.

#include <array>

#include "fsw/control/plan.h"
#include "fsw/control/primer.h"
#include "fsw/packets/message_traits.h"

namespace vbar::fsw::control {

/// Maximum number of candidate times; on longer horizons the grid widens.
inline constexpr std::size_t kMaxGridTimes = 640;

struct KoenigDamicoSettings {
  Duration grid_step = duration_of_seconds(30);  ///< > 0; upper limit if their number allows
  ThrustCost cost = ThrustCost::kSteerable;
  ThrustWindows windows;
  double negligible_change_m = 1e-6;  ///< |a pseudo_state| below which no burn is planned
  PrimerSettings primer;
};

/// Holds the workspace and the last solution in full; about 120 kB, too large for the stack of a flight computer.
struct KoenigDamicoWorkspace {
  std::array<Matrix63, kMaxGridTimes> effects;
  std::array<ThrustCost, kMaxGridTimes> costs{};
  std::array<GpsTime, kMaxGridTimes> times;
  PrimerWorkspace primer;
  PrimerSolution solution;  ///< impulses of the deputy; valid after a solve that returned a plan
};

/// Returns burns of the servicer (at most kMaxImpulses, from `start` to `arrival`, both included) that achieve the
/// pseudo-state at minimum cost, within settings.primer.cost_tolerance of the optimum on the grid. Errors:
/// kInvalidArgument (settings), kNotFinite, kOutOfRange (orbit or horizon, arrival before start), kSingular (no time
/// allowed, or too few or too close to reach every state), kDidNotConverge.
Result<Plan> solve_koenig_damico(const ControlProblem& problem, const KoenigDamicoSettings& settings,
                                 KoenigDamicoWorkspace& workspace);

/// The entry of the solver list (solver_list.h).
struct KoenigDamico {
  static constexpr Solver kId{waypoint::kSolverKoenigDamico};
  static constexpr const char* kName = "koenig_damico";
  static constexpr const char* kDescription =
      "the primer-vector solver on a uniform grid of times (Koenig and D'Amico)";
  /// Largest mean eccentricity: beyond it the time grid is too coarse about the perigee.
  static constexpr double kMaxEccentricity = 0.11;
  static constexpr auto kStatus = &telemetry_control::koenig_damico_status;

  using Settings = KoenigDamicoSettings;
  using Workspace = KoenigDamicoWorkspace;
  static Settings settings(const gnc_configuration& configuration, const ThrustWindows& windows);
  static Result<Plan> solve(const ControlProblem& problem, const Settings& settings, Workspace& workspace) {
    return solve_koenig_damico(problem, settings, workspace);
  }
};

}  // namespace vbar::fsw::control
