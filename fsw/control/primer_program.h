#pragma once
// The small convex program inside the Koenig-D'Amico solver: over the few times of its active set,
//
//     maximise w' lambda   subject to   |G_k' lambda| <= 1   for every active impulse k,
//
// a second-order cone program in six variables whose Lagrange multipliers are the impulses: w = sum_k G_k u_k with the
// minimum sum |u_k|. Solved by a primal-dual interior-point method with Nesterov-Todd scaling and Mehrotra's
// predictor-corrector (as in Vandenberghe, "The CVXOPT linear and quadratic cone program solvers", 2010, and Domahidi
// et al., "ECOS", 2013), specialised: the cone point s_k = (1, G_k' lambda) is a function of lambda, so each step is
// one 6x6 Cholesky factor with two right-hand sides.

#include <array>
#include <cstddef>

#include "fsw/control/thrust_cost.h"
#include "fsw/core/result.h"
#include "fsw/core/types.h"

namespace vbar::fsw::control {

/// Largest size of the active set: the coarse times of three thruster pairs, and twelve more.
inline constexpr std::size_t kMaxActive = 48;

/// Holds an impulse of the program, with the multiplier (bound, -dv) of its cone: |dv| <= bound, equal at the optimum.
struct ActiveImpulse {
  Matrix63 effect = Matrix63::Zero();  ///< change of the scaled state per impulse; zero columns for axes outside `axes`
  std::size_t time_index = 0;          ///< index in the grid
  AxisSet axes = 0;
  Vector3 dv = Vector3::Zero();
  double bound = 0.0;
};

/// Holds the program, its current point and the Nesterov-Todd scaling, in one fixed-size object. State and impulses are
/// scaled by the caller so that |target| = 1 and the effects are of order one.
struct PrimerProgram {
  Vector6 target = Vector6::Zero();
  Vector6 lambda = Vector6::Zero();
  std::array<ActiveImpulse, kMaxActive> active{};
  std::size_t count = 0;

  /// Holds the scaling of one cone and the directions of a step in it.
  struct Cone {
    double scale_inv_squared = 0.0;  ///< eta^-2
    double scale = 0.0;              ///< eta
    double w0 = 0.0;                 ///< normalised scaling point (w0, w), w0^2 - |w|^2 = 1
    Vector3 w = Vector3::Zero();
    Vector3 primer = Vector3::Zero();  ///< s = (1, primer)
    double slack = 0.0;                ///< 1 - |primer|^2
    double multiplier_slack = 0.0;     ///< bound^2 - |dv|^2
    double correction0 = 0.0;          ///< the corrector's part of the multiplier's step
    Vector3 correction = Vector3::Zero();
    double step0 = 0.0;  ///< step of the multiplier
    Vector3 step = Vector3::Zero();
    Vector3 primer_step = Vector3::Zero();
  };
  std::array<Cone, kMaxActive> cone{};
};

struct PrimerProgramEnd {
  Status status = Status::kOk;
  int steps = 0;  ///< Newton steps taken
};

/// Starts from scratch: lambda strictly inside, multipliers strictly inside their cones and meeting w = sum G u.
/// kSingular if the active effects do not span the state space.
Status start_primer_program(PrimerProgram& program);

/// Starts from the current lambda after the active set has changed: lambda is shrunk to the interior, the multipliers
/// are set near the central path, as if lambda were on it, satisfying w = sum G u. kSingular as above.
Status restart_primer_program(PrimerProgram& program);

/// Improves the current point until the duality gap is below `relative_gap` of the cost and w - sum G u below the same
/// part of |w|. kDidNotConverge after `max_steps` Newton steps; kSingular or kNotFinite if a step cannot be computed.
PrimerProgramEnd solve_primer_program(PrimerProgram& program, double relative_gap, int max_steps);

// From the multipliers of the primer program to a small number of exact impulses.

/// Reduces the program's impulses in place to at most six with the same sum G u and no greater cost (Caratheodory),
/// then drops those below `prune_ratio` of the largest and joins those at neighbouring times, where the others can make
/// compensate it and the cost stays below `cost_limit`; finally reaches the target to rounding. `program.count` is the
/// number left.
void extract_impulses(PrimerProgram& program, double prune_ratio, double cost_limit);

/// |target - sum G u|.
double impulse_residual(const PrimerProgram& program);

}  // namespace vbar::fsw::control
