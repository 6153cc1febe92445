#pragma once
// The policy of one leg: what to do with the plan at each decision on the way to a waypoint.
//
// Replanning at every decision chatters: burn times of equal cost alternate with every metre of change, and a leg
// can cost three times its optimum. A plan is therefore kept while it arrives; then its burns are corrected in place;
// only then is the leg replanned. The plan of any solver can be evaluated and corrected here.

#include "fsw/control/arrival.h"
#include "fsw/control/closed_form.h"
#include "fsw/control/correction.h"
#include "fsw/control/plan.h"

namespace vbar::fsw::control {

/// The solver that decide_leg() replans by.
using LegSolver = ClosedForm;

/// Holds the inputs of a decision.
struct LegSituation {
  MeanOrbits orbits;      ///< now
  Plan committed;         ///< commanded, not yet flown, all before `earliest_burn`
  GpsTime earliest_burn;  ///< now plus the command latency
  Waypoint waypoint;
  Vector6 sigma_roe = Vector6::Zero();  ///< 1 sigma of the estimated ROE now, dimensionless
};

struct LegPolicy {
  /// Largest arrival error of a plan that is kept, as a length (ROE times the semi-major axis, m), unless 1 sigma is
  /// larger.
  double tolerance_m = 1.0;
  /// Largest share by which corrected burns cost more than before, besides the cost of the error as a change of
  /// inclination, the most expensive one. Beyond it replanning may be cheaper.
  double max_cost_increase = 0.02;
  /// Worth of an arrival error that is avoided, as a multiple of the delta-v that removes it on the following leg. On
  /// that leg an orbit is available; a correction costs this multiple when about its inverse in radians of the orbit is
  /// left: 200 s.
  double miss_price = 5.0;
  CorrectionSettings correction;
  ClosedFormSettings closed_form;
};

/// Returns the desired mean ROE at the waypoint minus those at which the committed burns and `plan` arrive,
/// dimensionless. Errors as fly().
Result<Vector6> evaluate_plan(const LegSituation& situation, const Plan& plan);

/// Returns 1 sigma, dimensionless, of the arrival error due to the uncertainty of the estimate. Errors of the elements
/// are assumed independent.
Vector6 arrival_sigma(const LegSituation& situation);

/// Returns whether an arrival error is negligible: the root sum square of its elements, each in units of the larger of
/// the tolerance and its 1 sigma, is below one.
bool arrives(const LegSituation& situation, const Vector6& error, const LegPolicy& policy);

/// Returns the expected cost of a plan, m/s: its delta-v, and the worth of the arrival error. Each element of the error
/// is the root sum square of the predicted one and 1 sigma of the estimate, its expected magnitude within a quarter: a
/// predicted error that the estimate does not know is worth little, because its correction leaves as much.
double expected_cost(const LegSituation& situation, const Plan& plan, const Vector6& error, const LegPolicy& policy);

/// Returns the closed-form solution of the rest of the leg, corrected on the nonlinear prediction. Errors of
/// remaining_problem(), solve_closed_form() and correct_plan().
Result<Plan> plan_closed_form(const LegSituation& situation, const LegPolicy& policy);

enum class LegAction : unsigned char {
  kKeep,      ///< the plan arrives
  kCorrect,   ///< same burn times, other impulses
  kReplan,    ///< a new closed-form plan
  kHandOver,  ///< none of these arrives: the leg is passed to another solver
};

struct LegDecision {
  LegAction action = LegAction::kHandOver;
  Plan plan;                        ///< plan of the action; at kHandOver the previous burns without the missed ones
  Vector6 error = Vector6::Zero();  ///< at the waypoint, with that plan, dimensionless
  Status closed_form = Status::kNotReady;  ///< status of the closed-form solver, if it was invoked
};

/// Makes the first half of a decision, for the plan of any solver: keeps or corrects it, else kHandOver. Errors of
/// fly().
Result<LegDecision> keep_or_correct(const LegSituation& situation, const Plan& plan, const LegPolicy& policy);

/// Makes one decision. Burns of `plan` before `earliest_burn` count as missed. Errors of fly(): then the state of the
/// leg is unknown.
Result<LegDecision> decide_leg(const LegSituation& situation, const Plan& plan, const LegPolicy& policy);

}  // namespace vbar::fsw::control
