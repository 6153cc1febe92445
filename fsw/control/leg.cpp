#include "fsw/control/leg.h"

#include "fsw/math/math.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::control {
namespace {

Plan still_possible(const Plan& plan, GpsTime earliest) {
  Plan possible;
  possible.solver = plan.solver;
  for (const Burn& burn : plan.all()) {
    if (burn.time >= earliest) possible.burns[possible.count++] = burn;
  }
  return possible;
}

// Holds a plan and its arrival error.
struct Candidate {
  Plan plan;
  Vector6 error = Vector6::Zero();
};

double orbital_speed(const LegSituation& situation) {
  return orbit::mean_motion(situation.orbits.servicer.a) * situation.orbits.servicer.a;
}

// Returns the limit of the cost of a correction: `error` as a change of inclination, the most expensive, and a share of
// the burns.
double affordable_dv(const LegSituation& situation, const Plan& plan, const Vector6& error, const LegPolicy& policy) {
  return (1.0 + policy.max_cost_increase) * plan.total_dv() + orbital_speed(situation) * error.norm();
}

// Returns `plan` if it arrives.
Result<Candidate> arriving(const LegSituation& situation, const Result<Plan>& plan, const LegPolicy& policy) {
  if (!plan.ok()) return plan.status();
  const Result<Vector6> error = evaluate_plan(situation, plan.value());
  if (!error.ok()) return error.status();
  if (!arrives(situation, error.value(), policy)) return Status::kDidNotConverge;
  return Candidate{plan.value(), error.value()};
}

}  // namespace

Result<Vector6> evaluate_plan(const LegSituation& situation, const Plan& plan) {
  const Result<MeanOrbits> at_start = fly(situation.orbits, situation.committed.all(), situation.earliest_burn);
  if (!at_start.ok()) return at_start.status();
  return arrival_error(at_start.value(), plan.all(), situation.waypoint);
}

Vector6 arrival_sigma(const LegSituation& situation) {
  const double to_go = seconds(situation.waypoint.time - situation.orbits.epoch);
  const Matrix6 transition = orbit::roe_transition_j2(situation.orbits.servicer, to_go);
  Vector6 sigma;
  for (int row = 0; row < 6; ++row) {
    sigma[row] = transition.row(row).transpose().cwiseProduct(situation.sigma_roe).norm();
  }
  return sigma;
}

bool arrives(const LegSituation& situation, const Vector6& error, const LegPolicy& policy) {
  const Vector6 sigma = arrival_sigma(situation);
  const double tolerance = policy.tolerance_m / situation.orbits.servicer.a;
  double sum = 0.0;
  for (int row = 0; row < 6; ++row) {
    const double unit = sigma[row] > tolerance ? sigma[row] : tolerance;
    sum += (error[row] / unit) * (error[row] / unit);
  }
  return sum <= 1.0;
}

double expected_cost(const LegSituation& situation, const Plan& plan, const Vector6& error, const LegPolicy& policy) {
  const Vector6 sigma = arrival_sigma(situation);
  double miss = 0.0;
  for (int row = 0; row < 6; ++row) miss += math::hypot(error[row], sigma[row]);
  return plan.total_dv() + policy.miss_price * orbital_speed(situation) * miss;
}

Result<Plan> plan_closed_form(const LegSituation& situation, const LegPolicy& policy) {
  // The residual that burns at the solver's times cannot reach, across the phase of the inclination change, is returned
  // to the problem and moves those times by seconds.
  constexpr int kRounds = 3;
  Result<ControlProblem> problem =
      remaining_problem(situation.orbits, situation.committed.all(), situation.earliest_burn, situation.waypoint);
  if (!problem.ok()) return problem.status();
  ControlProblem adjusted = problem.value();
  Result<Plan> plan = Status::kNotReady;
  for (int round = 0; round < kRounds; ++round) {
    plan = solve_closed_form(adjusted, policy.closed_form);
    if (!plan.ok() || plan.value().count == 0) return plan;
    plan = correct_plan(situation.orbits, situation.committed, plan.value(), situation.waypoint, policy.correction);
    if (!plan.ok()) return plan;
    const Result<Vector6> error = evaluate_plan(situation, plan.value());
    if (!error.ok()) return error.status();
    adjusted.pseudo_state += error.value();
  }
  return plan;
}

Result<LegDecision> keep_or_correct(const LegSituation& situation, const Plan& plan, const LegPolicy& policy) {
  LegDecision decision;
  decision.plan = still_possible(plan, situation.earliest_burn);
  const Result<Vector6> error = evaluate_plan(situation, decision.plan);
  if (!error.ok()) return error.status();
  decision.error = error.value();
  if (arrives(situation, decision.error, policy)) {
    decision.action = LegAction::kKeep;
    return decision;
  }
  if (decision.plan.count == 0) return decision;
  const Result<Candidate> corrected = arriving(
      situation,
      correct_plan(situation.orbits, situation.committed, decision.plan, situation.waypoint, policy.correction),
      policy);
  const double affordable = affordable_dv(situation, decision.plan, decision.error, policy);
  if (corrected.ok() && corrected.value().plan.total_dv() <= affordable) {
    decision.action = LegAction::kCorrect;
    decision.plan = corrected.value().plan;
    decision.error = corrected.value().error;
  }
  return decision;
}

Result<LegDecision> decide_leg(const LegSituation& situation, const Plan& plan, const LegPolicy& policy) {
  const Result<LegDecision> first = keep_or_correct(situation, plan, policy);
  if (!first.ok() || first.value().action != LegAction::kHandOver) return first;
  LegDecision decision = first.value();
  const Result<Candidate> replanned = arriving(situation, plan_closed_form(situation, policy), policy);
  decision.closed_form = replanned.status();
  const bool first_plan = plan.count == 0;
  const double affordable = affordable_dv(situation, decision.plan, decision.error, policy);
  if (replanned.ok() && (first_plan || replanned.value().plan.total_dv() <= affordable)) {
    decision.action = LegAction::kReplan;
    decision.plan = replanned.value().plan;
    decision.error = replanned.value().error;
  }
  return decision;
}

}  // namespace vbar::fsw::control
