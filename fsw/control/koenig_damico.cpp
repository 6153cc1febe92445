#include "fsw/control/koenig_damico.h"

#include <algorithm>

#include "fsw/control/arrival.h"
#include "fsw/control/plan.h"

namespace vbar::fsw::control {
namespace {

/// Returns the number of intervals of the grid: not longer than the step requested, unless that requires too many.
std::int64_t grid_intervals(Duration horizon, Duration step) {
  const std::int64_t wanted = horizon.ns / step.ns + (horizon.ns % step.ns != 0 ? 1 : 0);
  return std::min(wanted, static_cast<std::int64_t>(kMaxGridTimes) - 1);
}

/// Fills in the candidate times and the effects of impulses there. Returns their number.
std::size_t make_grid(const ControlProblem& problem, const KoenigDamicoSettings& settings,
                      KoenigDamicoWorkspace& workspace) {
  const Duration horizon = problem.arrival - problem.start;
  const std::int64_t intervals = grid_intervals(horizon, settings.grid_step);
  std::size_t count = 0;
  for (std::int64_t k = 0; k <= intervals; ++k) {
    // 30 days times 640 stays below 2^63 ns.
    const GpsTime time = problem.start + Duration{intervals > 0 ? horizon.ns * k / intervals : 0};
    const ThrustWindows& windows = settings.windows;
    if (windows.allowed != nullptr && !windows.allowed(windows.context, time)) continue;
    workspace.times[count] = time;
    workspace.costs[count] = settings.cost;
    workspace.effects[count] = arrival_effect(problem.servicer_mean, problem.start, time, problem.arrival);
    ++count;
  }
  return count;
}

}  // namespace

Result<Plan> solve_koenig_damico(const ControlProblem& problem, const KoenigDamicoSettings& settings,
                                 KoenigDamicoWorkspace& workspace) {
  if (settings.grid_step.ns <= 0 || !(settings.negligible_change_m >= 0.0)) return Status::kInvalidArgument;
  const Status checked = check_problem(problem);
  if (checked != Status::kOk) return checked;

  Plan plan;
  plan.solver = KoenigDamico::kId;
  if (problem.servicer_mean.a * problem.pseudo_state.norm() < settings.negligible_change_m) {
    workspace.solution = {};
    return plan;
  }
  const std::size_t count = make_grid(problem, settings, workspace);
  const ImpulseGrid grid{{workspace.effects.data(), count}, {workspace.costs.data(), count}};
  const Result<PrimerSolution> solution = solve_primer(grid, problem.pseudo_state, settings.primer, workspace.primer);
  if (!solution.ok()) return solution.status();

  workspace.solution = solution.value();
  plan.count = workspace.solution.count;
  for (std::size_t k = 0; k < plan.count; ++k) {
    const Impulse& impulse = workspace.solution.impulses[k];
    plan.burns[k] = {workspace.times[impulse.time_index], -impulse.dv};
  }
  return plan;
}

KoenigDamicoSettings KoenigDamico::settings(const gnc_configuration& configuration, const ThrustWindows& windows) {
  Settings settings;
  settings.grid_step = {configuration.koenig_damico_grid_ns};
  settings.windows = windows;
  return settings;
}

}  // namespace vbar::fsw::control
