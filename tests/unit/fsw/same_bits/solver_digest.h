#pragma once
// Digest of the optimising control solvers' plans over random problems.

#include <memory>

#include "fsw/control/koenig_damico.h"
#include "fsw/control/least_squares.h"
#include "tests/unit/fsw/same_bits/digest.h"

namespace vbar::same_bits {

inline void add(Digest& digest, const fsw::Result<fsw::control::Plan>& plan) {
  digest.add(static_cast<double>(plan.status()));
  for (std::size_t k = 0; k < plan.value().count; ++k) {
    const fsw::control::Burn& burn = plan.value().burns[k];
    digest.add(static_cast<double>(burn.time.ns));
    for (int axis = 0; axis < 3; ++axis) digest.add(burn.dv_rtn(axis));
  }
}

/// Horizons of 0.2 to 3 orbits, changes of up to kilometres, every kind of thruster.
inline std::uint64_t solver_digest() {
  namespace control = fsw::control;
  Arguments arguments(6);
  Digest digest;
  const auto workspace = std::make_unique<control::KoenigDamicoWorkspace>();
  constexpr control::ThrustCost kCosts[] = {control::ThrustCost::kSteerable, control::ThrustCost::kOrthogonalPairs,
                                            control::ThrustCost::kRadialAndPlane};
  for (int k = 0; k < 60; ++k) {
    control::ControlProblem problem;
    problem.arrival = problem.start + fsw::nearest_duration(arguments.between(1200.0, 18000.0));
    problem.servicer_mean = {.a = arguments.between(6.9e6, 7.6e6),
                             .ex = arguments.between(-0.01, 0.01),
                             .ey = arguments.between(-0.01, 0.01),
                             .i = arguments.between(0.5, 2.5),
                             .raan = 0.0,
                             .u = arguments.between(-3.0, 3.0)};
    for (int j = 0; j < 6; ++j) problem.pseudo_state(j) = arguments.magnitude(-23, -14);
    control::KoenigDamicoSettings settings;
    settings.cost = kCosts[k % 3];
    add(digest, control::solve_koenig_damico(problem, settings, *workspace));
    add(digest, control::solve_least_squares(problem));
  }
  return digest.value();
}

}  // namespace vbar::same_bits
