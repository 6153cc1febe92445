#include "fsw/guidance/guidance.h"

#include <algorithm>
#include <limits>
#include <span>
#include <tuple>
#include <type_traits>

#include "fsw/guidance/drift_assessment.h"
#include "fsw/math/math.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"

namespace vbar::fsw::guidance {
namespace {

using control::Plan;
using control::Solver;

/// A correction of a plan that costs more than this multiple of it is replaced by a new plan. For the fuel-optimal
/// solver replanning costs computing time only, while correcting a plan whose burn was missed can cost twice as much as
/// a new plan.
constexpr double kReplanCostRatio = 1.1;

bool is_flyable(const Plan& plan, const gnc_configuration& configuration) {
  for (const control::Burn& burn : plan.all()) {
    if (!burn.dv_rtn.allFinite() || burn.dv_rtn.norm() > configuration.maximum_dv) return false;
  }
  return true;
}

bool is_safe(const Result<safety::PlanSafety>& verdict) {
  return verdict.ok() && verdict.value().safe;
}

/// Returns the uncertainty of the estimate: three sigma of position, and of the along-track drift due to the
/// uncertainty of da.
safety::PositionBound three_sigma(const Vector6& sigma_rtn, double sigma_a_da_m,
                                  const orbit::QnsElements& servicer_mean) {
  safety::PositionBound bound;
  bound.radial_normal = 3.0 * math::hypot(sigma_rtn(0), sigma_rtn(2));
  bound.along_track = 3.0 * sigma_rtn(1);
  bound.along_track_rate = 3.0 * 1.5 * orbit::mean_motion(servicer_mean.a) * sigma_a_da_m;
  return bound;
}

void drop_burns_before(Plan& plan, GpsTime time) {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < plan.count; ++k) {
    if (plan.burns[k].time >= time) plan.burns[kept++] = plan.burns[k];
  }
  plan.count = kept;
}

void remove_first(Plan& plan) {
  for (std::size_t k = 1; k < plan.count; ++k) plan.burns[k - 1] = plan.burns[k];
  --plan.count;
}

/// Returns the commanded burns, followed by those that are only planned. Both are in order of time; all commanded burns
/// are earlier.
Plan joined(const Plan& pending, const Plan& planned) {
  Plan all = pending;
  for (std::size_t k = 0; k < planned.count && all.count < control::kMaxBurns; ++k) {
    all.burns[all.count++] = planned.burns[k];
  }
  return all;
}

}  // namespace

void Guidance::assess(GpsTime now, const navigation::NavigationSolution& navigation,
                      const filter::RelativeNavigationFilter& filter, const Management& management) {
  situation_known_ = false;
  const navigation::NavigationState& state = navigation.state();
  if (!state.valid) return;
  const Result<orbit::QnsElements> servicer_osculating = orbit::qns_from_cartesian(state.servicer);
  const Result<orbit::QnsElements> target_osculating = orbit::qns_from_cartesian(state.target);
  if (!servicer_osculating.ok() || !target_osculating.ok()) return;
  const Result<orbit::QnsElements> servicer = orbit::mean_from_osculating(servicer_osculating.value());
  const Result<orbit::QnsElements> target = orbit::mean_from_osculating(target_osculating.value());
  if (!servicer.ok() || !target.ok()) return;

  const gnc_configuration& configuration = management.configuration();
  situation_known_ = true;
  set_limits(management);
  discard_past_burns(now);
  orbits_ = {now, servicer.value(), target.value()};
  report_.roe = orbit::roe_from_qns(orbits_.servicer, orbits_.target);
  const Vector6 sigma_a_roe_m = navigation.sigma_a_roe_m(filter);
  sigma_roe_ = sigma_a_roe_m / orbits_.servicer.a;
  position_bound_ = three_sigma(state.sigma_rtn, sigma_a_roe_m(0), orbits_.servicer);
  covariance_m2_ = navigation.a_roe_covariance_m2(filter);
  if (management.safety() != nullptr) {
    safety_ = *management.safety();
  } else {
    safety_.reset();
  }
  const filter::FilterSettings& settings = filter.settings();
  burn_uncertainty_ =
      safety_ ? safety::BurnUncertainty{settings.burn_sigma, settings.burn_sigma_relative} : safety::BurnUncertainty{};
  earliest_burn_ = now + Duration{configuration.compute_latency_ns};
  // Only cameras depend on light; with carrier phase or true states burns are measured at any time.
  const bool is_by_camera = state.source != navigation::NavigationSource::kIdeal &&
                            state.source != navigation::NavigationSource::kGnssFixed &&
                            state.source != navigation::NavigationSource::kGnssFloat;
  lit_ = safety_ && is_by_camera ? std::optional(LitWindows(now, orbits_.servicer)) : std::nullopt;
  const Result<safety::PlanSafety> ahead = safety_of(plan_, configuration);
  if (ahead.ok()) report_.passive_safety_distance = ahead.value().min_distance;
}

double Guidance::keep_out(const gnc_configuration& configuration) const {
  return goal_.keep_out_radius_m > 0.0 ? goal_.keep_out_radius_m : configuration.keep_out_radius_m;
}

std::optional<DriftSituation> Guidance::drift_situation() const {
  if (!situation_known_) return std::nullopt;
  const Result<control::MeanOrbits> orbits = control::fly(orbits_, pending_.all(), earliest_start());
  if (!orbits.ok()) return std::nullopt;
  return DriftSituation{.orbits = orbits.value(), .bound = position_bound_, .covariance_m2 = covariance_m2_};
}

void Guidance::update(GpsTime now, Duration period, const navigation::NavigationSolution& navigation,
                      const Management& management, RetreatSequence& retreat, bool may_plan) {
  command_count_ = 0;
  report_.waypoint_index = -1;
  const gnc_configuration& configuration = management.configuration();
  if (retreat.phase() == RetreatSequence::Phase::kBurn) return command_retreat(now, configuration, retreat);
  const double age = seconds(now - navigation.state().last_measurement);
  const bool plans = may_plan && situation_known_ && age <= configuration.navigation_timeout_s &&
                     now.ns >= configuration.planner_start_ns && select_goal(now, management, retreat);
  if (!plans) return drop_plan();
  if (decision_is_due(now, configuration)) decide(configuration);
  commit_due_burns(now, period, configuration);
}

void Guidance::drop_plan() {
  plan_ = {};
  has_goal_ = false;
  is_holding_ = false;
  report_.active_solver = Solver::kNone;
}

/// Commands the burn of the retreat. It needs neither a plan nor a present estimate: the last step with an estimate has
/// prepared it.
void Guidance::command_retreat(GpsTime now, const gnc_configuration& configuration, RetreatSequence& retreat) {
  drop_plan();
  earliest_burn_ = now + Duration{configuration.compute_latency_ns};
  pending_ = control::remaining(pending_, limits_, now);
  const control::Burn burn{.time = earliest_start(), .dv_rtn = retreat.burn_at(earliest_start())};
  retreat.commanded(burn.time);
  if (burn.dv_rtn.norm() < configuration.minimum_dv || pending_.count == control::kMaxBurns) return;
  commands_[command_count_++] = {next_maneuver_id_++, -1, Solver::kNone, burn};
  pending_.burns[pending_.count++] = burn;
  commanded_dv_ += burn.dv_rtn.norm();
}

/// Selects the waypoint ahead and sets `goal_`. A new goal discards the plan of the previous one.
bool Guidance::select_goal(GpsTime now, const Management& management, const RetreatSequence& retreat) {
  switch (management.mode()) {
    case Mode::kIdle:
    case Mode::kHold:
      return false;
    case Mode::kApproach:
      if (management.next_waypoint() == nullptr) return false;
      set_goal(now, *management.next_waypoint());
      return true;
    case Mode::kStationKeeping:
      return select_kept_orbit(now, management, management.last_waypoint());
    case Mode::kRetreat:
      return select_kept_orbit(now, management, retreat.hold_orbit());
  }
  return false;
}

/// Selects the orbit to be kept while a correction is under way, and when the error exceeds the deadband.
bool Guidance::select_kept_orbit(GpsTime now, const Management& management, const Waypoint* kept) {
  if (kept == nullptr) return false;
  if (has_goal_ && goal_.index == kept->index && goal_.roe == kept->roe && goal_.time > now) {
    report_.waypoint_index = goal_.index;
    return true;
  }
  const gnc_configuration& configuration = management.configuration();
  const Vector6 error_m = management.reference_semi_major_axis() * (report_.roe - kept->roe);
  if (error_m.norm() <= configuration.station_keeping_deadband_m) return false;
  Waypoint stay = *kept;
  stay.time = now + nearest_duration(configuration.station_keeping_horizon_s);
  set_goal(now, stay);
  return true;
}

void Guidance::set_goal(GpsTime now, const Waypoint& wanted) {
  if (!has_goal_ || wanted.index != goal_.index || wanted.time != goal_.time) {
    plan_ = {};
    next_decision_ = now;
    is_holding_ = false;
    report_.active_solver = Solver::kNone;
  }
  goal_ = wanted;
  has_goal_ = true;
  report_.waypoint_index = goal_.index;
  report_.roe_desired = goal_.roe;
}

bool Guidance::decision_is_due(GpsTime now, const gnc_configuration& configuration) {
  if (now < next_decision_) return false;
  const bool is_far = is_leg_of(control::LegSolver::kId);
  next_decision_ = now + Duration{is_far ? configuration.closed_form_period_ns : configuration.koenig_damico_period_ns};
  return true;
}

void Guidance::decide(const gnc_configuration& configuration) {
  if (goal_.time <= earliest_start()) return;  // this waypoint cannot be influenced any more
  const double sigma_m = orbits_.servicer.a * sigma_roe_.maxCoeff();
  const bool too_coarse = configuration.roe_error_threshold_m > 0.0 && sigma_m > configuration.roe_error_threshold_m;
  is_holding_ = !stays_on_plan(configuration, too_coarse) && !solver_fallback(configuration, too_coarse);
  if (!is_holding_) return;
  plan_ = {};
  report_.active_solver = Solver::kNone;
  ++report_.holds;
}

/// Keeps or corrects the plan, or replans by the solver of the leg's policy. While the estimate is too coarse, only a
/// plan of the last solver is kept.
bool Guidance::stays_on_plan(const gnc_configuration& configuration, bool estimate_too_coarse) {
  alternative_.reset();
  if (estimate_too_coarse && report_.active_solver != control::LastSolver::kId) return false;
  const control::LegSituation situation = leg_situation();
  const bool replans = !estimate_too_coarse && is_leg_of(control::LegSolver::kId);
  const Result<control::LegDecision> decision =
      replans ? control::decide_leg(situation, plan_, leg_policy(configuration))
              : control::keep_or_correct(situation, plan_, leg_policy(configuration));
  if (!decision.ok()) return false;
  const control::LegDecision& decided = decision.value();
  if (report_.active_solver != Solver::kNone) alternative_ = decided.plan;
  if (decided.action == control::LegAction::kHandOver) {
    if (replans) status_of(control::LegSolver::kId) = decided.closed_form;
    return false;
  }
  if (decided.action == control::LegAction::kReplan) status_of(control::LegSolver::kId) = decided.closed_form;
  const bool is_expensive = decided.plan.total_dv() > kReplanCostRatio * plan_.total_dv();
  if (!replans && decided.action == control::LegAction::kCorrect && is_expensive) return false;
  return adopt_if_flyable(decided.plan, configuration);
}

/// Plans the rest of the leg from scratch.
template <class Entry>
Result<Plan> Guidance::solve(const gnc_configuration& configuration) {
  const control::LegSituation situation = leg_situation();
  const Result<control::ControlProblem> problem = control::remaining_problem(
      situation.orbits, situation.committed.all(), situation.earliest_burn, situation.waypoint);
  if (!problem.ok()) return problem.status();
  const control::ThrustWindows windows = lit_ ? lit_->thrust_windows() : control::ThrustWindows{};
  return Entry::solve(problem.value(), Entry::settings(configuration, windows),
                      std::get<typename Entry::Workspace>(workspaces_));
}

/// Tries the solvers from that of the leg to the last one, or the last one alone while the estimate is too coarse. The
/// solver that the policy of the leg replans by has been tried there.
bool Guidance::solver_fallback(const gnc_configuration& configuration, bool estimate_too_coarse) {
  const Solver first = estimate_too_coarse ? control::LastSolver::kId : static_cast<Solver>(goal_.control_mode);
  const std::size_t first_place = control::place_of(first);
  return control::any_solver([&]<class Entry>(std::size_t place) {
    if constexpr (std::is_same_v<Entry, control::LegSolver>) {
      return false;
    } else {
      if (place < first_place) return false;
      if (place > first_place) ++report_.solver_fallbacks;
      const Result<Plan> candidate = solve<Entry>(configuration);
      report_.status[place] = candidate.status();
      return candidate.ok() && adopt_cheaper(refined(candidate.value()), configuration);
    }
  });
}

/// Adopts a new plan, or the previous one with or without a correction, if its miss is worth less than the difference
/// in delta-v: a solver reaches the waypoint at any cost, which grows without bound as the arrival approaches.
bool Guidance::adopt_cheaper(const Plan& candidate, const gnc_configuration& configuration) {
  if (alternative_) {
    const Plan corrected = refined(*alternative_);
    const double kept_cost = expected_cost(*alternative_, configuration);
    const double corrected_cost = expected_cost(corrected, configuration);
    const bool is_cheaper = std::min(kept_cost, corrected_cost) < expected_cost(candidate, configuration);
    if (is_cheaper && adopt_if_flyable(corrected_cost < kept_cost ? corrected : *alternative_, configuration)) {
      return true;
    }
  }
  return adopt_if_flyable(candidate, configuration);
}

/// Returns the expected cost of a plan for the leg, m/s; infinite if it cannot be predicted.
double Guidance::expected_cost(const Plan& plan, const gnc_configuration& configuration) const {
  const control::LegSituation situation = leg_situation();
  const Result<Vector6> error = control::evaluate_plan(situation, plan);
  if (!error.ok()) return std::numeric_limits<double>::infinity();
  return control::expected_cost(situation, plan, error.value(), leg_policy(configuration));
}

/// Corrects the burns of a solver for the nonlinear model, if that reduces the error: solvers are linear.
Plan Guidance::refined(const Plan& candidate) const {
  const control::LegSituation situation = leg_situation();
  const Result<Plan> corrected =
      control::correct_plan(situation.orbits, situation.committed, candidate, situation.waypoint);
  if (!corrected.ok()) return candidate;
  const Result<Vector6> before = control::evaluate_plan(situation, candidate);
  const Result<Vector6> after = control::evaluate_plan(situation, corrected.value());
  if (!before.ok() || !after.ok() || after.value().norm() >= before.value().norm()) return candidate;
  return corrected.value();
}

/// Divides what the thruster cannot fly at once, and corrects the sizes of all burns for it. What is left over remains
/// as the arrival error that the next plan begins with.
Plan Guidance::flyable(const Plan& candidate) const {
  if (control::can_fly(candidate, limits_, burn_span())) return candidate;
  const Plan parts = control::without_small_burns(control::divided(candidate, limits_, burn_span()), limits_);
  const Plan corrected = control::limited(refined(parts), limits_);
  const Result<Vector6> before = control::evaluate_plan(leg_situation(), parts);
  const Result<Vector6> after = control::evaluate_plan(leg_situation(), corrected);
  return after.ok() && before.ok() && after.value().norm() < before.value().norm() ? corrected : parts;
}

bool Guidance::adopt_if_flyable(const Plan& wanted, const gnc_configuration& configuration) {
  const Plan candidate = flyable(wanted);
  if (!is_flyable(candidate, configuration)) {
    status_of(candidate.solver) = Status::kOutOfRange;
    return false;
  }
  const Result<Vector6> error = control::evaluate_plan(leg_situation(), candidate);
  if (!error.ok()) return false;
  const Result<safety::PlanSafety> verdict = safety_of(candidate, configuration);
  report_.safety = verdict.ok() && !verdict.value().safe ? Status::kUnsafe : verdict.status();
  if (!is_safe(verdict)) {
    ++report_.plans_unsafe;
    return false;
  }
  plan_ = candidate;
  report_.active_solver = candidate.solver;
  report_.predicted_roe_error = error.value();
  report_.passive_safety_distance = verdict.value().min_distance;
  return true;
}

control::LegSituation Guidance::leg_situation() const {
  return {orbits_, pending_, earliest_start(), {goal_.time, goal_.roe}, sigma_roe_};
}

/// A far leg, replanned by its policy, must arrive within the error that an orbit of corrections removes at negligible
/// cost; the other legs within millimetres.
control::LegPolicy Guidance::leg_policy(const gnc_configuration& configuration) const {
  control::LegPolicy policy;
  const bool is_far = is_leg_of(control::LegSolver::kId);
  policy.tolerance_m = is_far ? configuration.closed_form_tolerance_m : configuration.koenig_damico_tolerance_m;
  return policy;
}

Result<safety::PlanSafety> Guidance::safety_of(const Plan& candidate, const gnc_configuration& configuration) const {
  const Plan all = joined(pending_, candidate);
  safety::SafetyCriterion criterion{.keep_out_radius = keep_out(configuration),
                                    .horizon = configuration.safety_horizon_s,
                                    .bound = position_bound_,
                                    .burns = burn_uncertainty_};
  if (safety_) {
    criterion.horizon = safety_->horizon_s;
    criterion.retreat = {.settings = retreat_settings(*safety_, position_bound_.radial_normal),
                         .delay = safety_->retreat_delay_s,
                         .covariance_m2 = covariance_m2_,
                         .maximum_collision_probability = safety_->maximum_collision_probability};
  }
  return safety::assess_plan(orbits_.epoch, orbits_.servicer, report_.roe, all, criterion);
}

/// Returns the earliest time of a new burn: after the latency and after all commanded burns.
GpsTime Guidance::earliest_start() const {
  if (pending_.count == 0) return earliest_burn_;
  const GpsTime after_pending = limits_.after(pending_.burns[pending_.count - 1]);
  return after_pending > earliest_burn_ ? after_pending : earliest_burn_;
}

/// Returns the times of burns of a plan for the leg.
control::BurnSpan Guidance::burn_span() const {
  const double rate = orbit::secular_rates(orbits_.servicer).mean_argument_of_latitude();
  return {.earliest = earliest_start(), .arrival = goal_.time, .revolution = nearest_duration(2.0 * math::kPi / rate)};
}

void Guidance::set_limits(const Management& management) {
  limits_ = {.acceleration = management.thruster().thrust_acceleration,
             .minimum_dv = management.configuration().minimum_dv,
             .maximum_dv = management.configuration().maximum_dv,
             .pause = nearest_duration(management.thruster().pause_s)};
}

/// Discards commanded burns that are over: the state contains them.
void Guidance::discard_past_burns(GpsTime now) {
  pending_ = control::remaining(pending_, limits_, now);
  drop_burns_before(plan_, now);  // a planned burn can only be past if steps were missed: it was never commanded
}

/// Commands every burn that could not be commanded in time in the next step.
void Guidance::commit_due_burns(GpsTime now, Duration period, const gnc_configuration& configuration) {
  const GpsTime next_chance = now + period + Duration{configuration.compute_latency_ns};
  while (plan_.count > 0 && plan_.burns[0].time < next_chance && command_count_ < kMaxCommandsPerStep &&
         pending_.count < control::kMaxBurns) {
    const control::Burn burn = plan_.burns[0];
    remove_first(plan_);
    const bool is_in_eclipse = lit_ && control::observes_windows(plan_.solver) && !lit_->allows(burn.time);
    if (is_in_eclipse) continue;
    if (burn.time < earliest_burn_ || burn.dv_rtn.norm() < configuration.minimum_dv) continue;
    commands_[command_count_++] = {next_maneuver_id_++, goal_.index, plan_.solver, burn};
    pending_.burns[pending_.count++] = burn;
    commanded_dv_ += burn.dv_rtn.norm();
  }
}

}  // namespace vbar::fsw::guidance
