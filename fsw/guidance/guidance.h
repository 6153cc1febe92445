#pragma once
// control: selection of waypoint, solver and fallback; commanding of burns.
//
// A plan is kept while it arrives. Otherwise the solvers are tried in the order of their list. A plan is accepted only
// if it passes the passive-safety test after every partial burn sequence. Without an accepted plan guidance holds: no
// burn is flown. A burn is commanded in the last step in which it is still possible, so that replanning may improve it.

#include <array>
#include <cstdint>
#include <optional>

#include "fsw/control/arrival.h"
#include "fsw/control/leg.h"
#include "fsw/control/plan.h"
#include "fsw/control/solver_list.h"
#include "fsw/control/thruster_limits.h"
#include "fsw/guidance/lit_windows.h"
#include "fsw/guidance/management.h"
#include "fsw/guidance/retreat_sequence.h"
#include "fsw/navigation/navigation.h"
#include "fsw/safety/passive_safety.h"

namespace vbar::fsw::guidance {

/// Holds the decisions of guidance in a step, for telemetry. Statuses are those of the last attempt.
struct GuidanceReport {
  control::Solver active_solver = control::Solver::kNone;
  std::array<Status, control::kSolvers> status = [] {  ///< of each solver, in the order of the list
    std::array<Status, control::kSolvers> all{};
    all.fill(Status::kNotReady);
    return all;
  }();
  Status safety = Status::kNotReady;
  std::int32_t waypoint_index = -1;
  Vector6 roe = Vector6::Zero();                  ///< estimated mean ROE now, dimensionless
  Vector6 roe_desired = Vector6::Zero();          ///< dimensionless mean ROE of the waypoint ahead
  Vector6 predicted_roe_error = Vector6::Zero();  ///< at the waypoint, remaining burns flown; dimensionless
  double passive_safety_distance = 0.0;           ///< m
  std::int32_t solver_fallbacks = 0;
  std::int32_t plans_unsafe = 0;
  std::int32_t holds = 0;
};

/// Describes the drift after the burns already commanded.
struct DriftSituation {
  control::MeanOrbits orbits;               ///< at the earliest time of another burn
  safety::PositionBound bound;              ///< 3 sigma
  Matrix6 covariance_m2 = Matrix6::Zero();  ///< of the mean ROE times a
};

/// Holds a burn to be commanded in this step.
struct CommandedBurn {
  std::int32_t maneuver_id = 0;
  std::int32_t waypoint_index = -1;
  control::Solver solver = control::Solver::kNone;
  control::Burn burn;
};

class Guidance {
 public:
  static constexpr std::size_t kMaxCommandsPerStep = 16;

  /// Derives the mean orbits of both spacecraft and the passive safety of the current plan.
  void assess(GpsTime now, const navigation::NavigationSolution& navigation,
              const filter::RelativeNavigationFilter& filter, const Management& management);

  /// Returns the drift after the commanded burns; nothing if the situation is unknown.
  [[nodiscard]] std::optional<DriftSituation> drift_situation() const;

  /// Discards past burns, replans if due and necessary, and collects the burns to command. `period` is the time to the
  /// next step. `may_plan` is false if a fault forbids all burns but the retreat's.
  void update(GpsTime now, Duration period, const navigation::NavigationSolution& navigation,
              const Management& management, RetreatSequence& retreat, bool may_plan);

  /// Returns whether no plan could be flown at the last decision.
  [[nodiscard]] bool is_holding() const { return is_holding_; }
  /// Returns the distance that drifts on the present leg must keep, m.
  [[nodiscard]] double keep_out(const gnc_configuration& configuration) const;
  [[nodiscard]] bool situation_known() const { return situation_known_; }
  [[nodiscard]] const GuidanceReport& report() const { return report_; }
  [[nodiscard]] std::size_t command_count() const { return command_count_; }
  [[nodiscard]] const CommandedBurn& command(std::size_t k) const { return commands_[k]; }
  /// Returns when a burn is over.
  [[nodiscard]] GpsTime end_of(const control::Burn& burn) const { return limits_.end_of(burn); }
  [[nodiscard]] const control::Plan& plan() const { return plan_; }
  [[nodiscard]] double commanded_dv() const { return commanded_dv_; }
  [[nodiscard]] std::int32_t commanded_maneuvers() const { return next_maneuver_id_; }

 private:
  bool select_goal(GpsTime now, const Management& management, const RetreatSequence& retreat);
  bool select_kept_orbit(GpsTime now, const Management& management, const Waypoint* kept);
  void set_goal(GpsTime now, const Waypoint& wanted);
  void drop_plan();
  void command_retreat(GpsTime now, const gnc_configuration& configuration, RetreatSequence& retreat);
  bool decision_is_due(GpsTime now, const gnc_configuration& configuration);
  void decide(const gnc_configuration& configuration);
  bool stays_on_plan(const gnc_configuration& configuration, bool estimate_too_coarse);
  bool solver_fallback(const gnc_configuration& configuration, bool estimate_too_coarse);
  bool adopt_cheaper(const control::Plan& candidate, const gnc_configuration& configuration);
  [[nodiscard]] double expected_cost(const control::Plan& plan, const gnc_configuration& configuration) const;
  bool adopt_if_flyable(const control::Plan& wanted, const gnc_configuration& configuration);
  [[nodiscard]] control::Plan refined(const control::Plan& candidate) const;
  [[nodiscard]] control::Plan flyable(const control::Plan& candidate) const;
  template <class Entry>
  Result<control::Plan> solve(const gnc_configuration& configuration);
  Status& status_of(control::Solver solver) { return report_.status[control::place_of(solver)]; }
  [[nodiscard]] bool is_leg_of(control::Solver solver) const {
    return static_cast<control::Solver>(goal_.control_mode) == solver;
  }
  [[nodiscard]] Result<safety::PlanSafety> safety_of(const control::Plan& candidate,
                                                     const gnc_configuration& configuration) const;
  [[nodiscard]] control::LegSituation leg_situation() const;
  [[nodiscard]] control::LegPolicy leg_policy(const gnc_configuration& configuration) const;
  [[nodiscard]] GpsTime earliest_start() const;
  [[nodiscard]] control::BurnSpan burn_span() const;
  void set_limits(const Management& management);
  void discard_past_burns(GpsTime now);
  void commit_due_burns(GpsTime now, Duration period, const gnc_configuration& configuration);

  // Results of assess(), used by the rest of the step.
  std::optional<safety_configuration> safety_;  ///< in force in this step
  bool situation_known_ = false;
  GpsTime earliest_burn_;
  control::ThrusterLimits limits_;
  control::MeanOrbits orbits_;
  std::optional<LitWindows> lit_;            ///< burns are restricted to sunlight
  Vector6 sigma_roe_ = Vector6::Zero();      ///< 1 sigma, dimensionless
  safety::PositionBound position_bound_;     ///< 3 sigma
  Matrix6 covariance_m2_ = Matrix6::Zero();  ///< covariance of the mean ROE times a
  safety::BurnUncertainty burn_uncertainty_;

  Waypoint goal_;
  bool has_goal_ = false;
  bool is_holding_ = false;
  control::Plan plan_;                        ///< still to be commanded
  control::Plan pending_;                     ///< commanded, not yet due, or the rest of a burn under way
  std::optional<control::Plan> alternative_;  ///< to a new plan in this decision: the previous one, which misses
  GpsTime next_decision_;
  std::array<CommandedBurn, kMaxCommandsPerStep> commands_{};
  std::size_t command_count_ = 0;
  double commanded_dv_ = 0.0;
  std::int32_t next_maneuver_id_ = 0;
  GuidanceReport report_;
  control::SolverWorkspaces workspaces_;
};

}  // namespace vbar::fsw::guidance
