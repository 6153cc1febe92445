#pragma once
// Closed-form impulsive control of near-circular relative motion (Chernick & D'Amico 2018; Chernick 2021).
//
// Tangential burns do the in-plane part, normal burns the out-of-plane part, each at the one phase of the orbit (twice a
// revolution, with opposite signs) where it does nothing but what is wanted. Three tangential burns meet da, dlambda and de; of
// all triples of admissible times the cheapest is the optimum over these times, since a basic solution of three equations has
// no more than three non-zero burns. The normal part is spread over the same revolutions, so that burns coincide and share
// their norm: 3.8 m/s over the mission's far range where separate burns cost 5.0.

#include "fsw/control/near_circular.h"
#include "fsw/control/plan.h"

namespace vbar::fsw::control {

/// In-plane burns (m/s along T, for a manoeuvring deputy) and what they cost against the bound.
struct TangentialScheme {
  std::array<double, 3> offset{};  ///< s after the start, increasing
  std::array<double, 3> dv{};      ///< m/s
  double cost = 0.0;               ///< sum of magnitudes, m/s
  ReachableBounds bounds;          ///< lower bounds of the same task
};

/// The cheapest three tangential burns for `pseudo_state`'s in-plane part. kNotReady: the window holds fewer than three
/// admissible times, or all of one parity (windows under about an orbit).
Result<TangentialScheme> cheapest_tangential_scheme(const NearCircularOrbit& orbit, const Vector6& pseudo_state,
                                                    double window);

/// The whole plan: scheme, normal burns, and their coupling through J2 and eccentricity taken out by iteration with the exact
/// linear effects until the residual is under 1e-9 of the pseudo-state. Errors as above; kInvalidArgument for an empty window;
/// kDidNotConverge; kNotFinite.
Result<Plan> solve_closed_form(const ControlProblem& problem);

}  // namespace vbar::fsw::control
