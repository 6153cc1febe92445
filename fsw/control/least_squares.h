#pragma once
// Time-fixed impulsive control by least squares with Tikhonov regularisation, as in Guffanti and D'Amico's backup
// solver: at two or three given times, the impulses x that minimise |W (A x - a w)|^2 + alpha |x|^2, A in metres of
// a*ROE per m/s. It always returns a solution at constant cost: the last fallback. Not fuel-optimal.

#include <cstddef>

#include "fsw/control/plan.h"
#include "fsw/packets/message_traits.h"

namespace vbar::fsw::control {

struct LeastSquaresSettings {
  std::size_t burn_count = 3;        ///< 2: at both ends of the horizon; 3: one between them too
  double regularisation = 1e2;       ///< alpha, m^2/(m/s)^2; 1e2 costs well under 1 mm, 1e5 tens of centimetres
  Vector6 weight = Vector6::Ones();  ///< diagonal of W, > 0: weight of the error of each ROE
};

/// Reports the conditioning of the problem and the residual of the plan.
struct LeastSquaresReport {
  double smallest_singular_value = 0.0;  ///< smallest singular value of W A, m per m/s
  double largest_singular_value = 0.0;
  double residual_m = 0.0;  ///< |A x - a w|, unweighted
  GpsTime middle;           ///< time of the third burn, if there is one
};

/// Returns burns of the servicer at the start, between and at the arrival. The burn between is in the middle, or, at a
/// singular spacing (half and whole orbits), at the best of a few other times. A pseudo-state of zero results in all
/// burns of the plan with zero size. Errors: kInvalidArgument (settings), kNotFinite, kOutOfRange (orbit, horizon),
/// kSingular: no choice of times makes the singular values span less than a factor 1e5.
Result<Plan> solve_least_squares(const ControlProblem& problem, const LeastSquaresSettings& settings = {},
                                 LeastSquaresReport* report = nullptr);

/// The entry of the solver list (solver_list.h).
struct LeastSquares {
  static constexpr Solver kId{waypoint::kSolverLeastSquares};
  static constexpr const char* kName = "least_squares";
  static constexpr const char* kDescription = "the least-squares solver on a uniform grid of times";
  /// Largest mean eccentricity, as that of the closed form.
  static constexpr double kMaxEccentricity = 0.06;
  static constexpr auto kStatus = &telemetry_control::least_squares_status;

  using Settings = LeastSquaresSettings;
  struct Workspace {};
  static Settings settings(const gnc_configuration& /*configuration*/, const ThrustWindows& /*windows*/) { return {}; }
  static Result<Plan> solve(const ControlProblem& problem, const Settings& settings, Workspace& /*workspace*/) {
    return solve_least_squares(problem, settings);
  }
};

}  // namespace vbar::fsw::control
