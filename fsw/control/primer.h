#pragma once
// Fuel-optimal impulsive control of a linear system over a grid of candidate times (Koenig & D'Amico 2020, IEEE Trans.
// Automatic Control 66(9), "Fast Algorithm for Fuel-Optimal Impulsive Control of Linear Systems with Time-Varying
// Cost"):
//
//     minimise sum_j cost_j(dv_j)   subject to   sum_j G_j dv_j = target,
//
// solved through its dual: maximise target' lambda with contact_j(G_j' lambda) <= 1 at every time j. G_j' lambda is the
// primer vector; impulses occur only where its contact function reaches 1. Independent of orbits: the effects G_j
// are given.

#include <array>
#include <cstddef>
#include <span>

#include "fsw/control/primer_program.h"
#include "fsw/control/thrust_cost.h"
#include "fsw/core/result.h"
#include "fsw/core/types.h"

namespace vbar::fsw::control {

/// Describes the candidate times, by index, in order of time. The caller owns the storage.
struct ImpulseGrid {
  std::span<const Matrix63> effects;  ///< change of the final state per impulse at each time (per m/s)
  std::span<const ThrustCost> costs;  ///< one per time
};

struct PrimerSettings {
  double cost_tolerance = 1e-3;  ///< the cost exceeds the optimum of the grid by at most this part; 1e-5 to 0.1
  double prune_ratio = 1e-3;     ///< impulses below this part of the largest are dropped if possible
  int max_rounds = 30;           ///< exchanges of the active set
  int max_newton_steps = 60;     ///< for each active set; 12 is typical
};

/// Largest number of impulses: six achieve the effect of any number at the same cost (Caratheodory).
inline constexpr std::size_t kMaxImpulses = 6;

struct Impulse {
  std::size_t time_index = 0;
  Vector3 dv = Vector3::Zero();
};

/// Holds the impulses in order of time, and the certificate of their optimality.
struct PrimerSolution {
  std::array<Impulse, kMaxImpulses> impulses{};
  std::size_t count = 0;
  double cost = 0.0;         ///< of the impulses, m/s
  double lower_bound = 0.0;  ///< lower bound of the cost on the grid: target' lambda, lambda feasible on all of it
  Vector6 lambda = Vector6::Zero();  ///< the dual variable behind lower_bound, m/s per unit of state
  double residual = 0.0;             ///< |target - sum G dv| / |target|, in the solver's scaling of the state
  int rounds = 0;                    ///< active sets solved
  int newton_steps = 0;              ///< over all rounds
};

/// Holds the workspace of the solver, about 18 kB.
struct PrimerWorkspace {
  PrimerProgram program;
};

/// Returns the impulses that achieve `target` at minimum cost. A zero target needs none. Errors: kInvalidArgument
/// (settings, sizes), kNotFinite (a target or an effect), kSingular (the times allowed do not span the state space:
/// none, too few, too close), kDidNotConverge.
Result<PrimerSolution> solve_primer(const ImpulseGrid& grid, const Vector6& target, const PrimerSettings& settings,
                                    PrimerWorkspace& workspace);

}  // namespace vbar::fsw::control
