#include "fsw/control/koenig_damico.h"
#include "fsw/control/least_squares.h"
#include "fsw/control/arrival.h"
namespace vbar::fsw::control {
Result<Plan> solve_koenig_damico(const ControlProblem& problem, const KoenigDamicoSettings& settings,
                                 KoenigDamicoWorkspace& workspace) {
  std::int64_t window = (problem.arrival - problem.start).ns;
  std::int64_t step = settings.grid_step.ns;
  while (window / step + 2 > 640) step *= 2;
  std::array<GpsTime, kMaxGrid> t;
  std::size_t n = 0;
  for (std::int64_t o = 0; o < window; o += step) t[n++] = problem.start + Duration{o};
  t[n++] = problem.arrival;
  for (std::size_t k = 0; k < n; ++k) {
    workspace.effects[k] = arrival_effect(problem.servicer_mean, problem.start, t[k], problem.arrival);
    workspace.costs[k] = ThrustCost::kSteerable;
  }
  PrimerSettings ps;
  auto s = solve_primer({{workspace.effects.data(), n}, {workspace.costs.data(), n}}, problem.pseudo_state, ps, workspace.primer);
  if (!s.ok()) return s.status();
  Plan plan;
  plan.solver = Solver::kKoenigDamico;
  for (std::size_t k = 0; k < s.value().count; ++k) plan.burns[plan.count++] = {t[s.value().impulses[k].time_index], -s.value().impulses[k].dv};
  return plan;
}
Result<Plan> solve_least_squares(const ControlProblem&) { return Status::kNotReady; }
}
