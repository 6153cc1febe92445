// 1200 random rendezvous problems against the optima of a general cone solver over the whole grid (CVXOPT), written by
// tests/peers/koenig/koenig_reference.py with an independent model of the impulses' effects.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/control/koenig_damico.h"
#include "tests/support/figures.h"
#include "tests/support/paths.h"

namespace vbar::fsw::control {
namespace {

constexpr double kDegree = M_PI / 180.0;

struct ReferenceProblem {
  ControlProblem problem;
  KoenigDamicoSettings settings;
  double optimum = 0.0;  ///< m/s
};

ThrustCost cost_named(const std::string& name) {
  if (name == "orthogonal_pairs") return ThrustCost::kOrthogonalPairs;
  if (name == "radial_and_plane") return ThrustCost::kRadialAndPlane;
  return ThrustCost::kSteerable;
}

ReferenceProblem parse(const std::string& line) {
  std::istringstream fields(line);
  std::string name, field;
  std::getline(fields, name, ',');
  std::vector<double> x;
  while (std::getline(fields, field, ',')) x.push_back(std::stod(field));

  ReferenceProblem reference;
  ControlProblem& problem = reference.problem;
  problem.start = {1'000'000'000'000'000'000};
  problem.arrival = problem.start + duration_of_seconds(static_cast<std::int64_t>(x[5]));
  problem.servicer_mean = {x[0] * 1e3, x[1], x[2], x[3] * kDegree, 0.0, x[4] * kDegree};
  for (int k = 0; k < 6; ++k) problem.pseudo_state(k) = x[static_cast<std::size_t>(7 + k)] / (x[0] * 1e3);
  const auto intervals = static_cast<std::int64_t>(x[6]) - 1;
  reference.settings.grid_step = {((problem.arrival - problem.start).ns + intervals - 1) / intervals};
  reference.settings.cost = cost_named(name);
  reference.optimum = x[13] * 1e-3;
  return reference;
}

std::vector<ReferenceProblem> read_problems() {
  std::ifstream file(vbar::tests::source_path("tests/unit/fsw/control/koenig_reference.csv"));
  std::string line;
  std::getline(file, line);
  std::vector<ReferenceProblem> problems;
  while (std::getline(file, line)) problems.push_back(parse(line));
  return problems;
}

double relative_residual(const ControlProblem& problem, const KoenigDamicoWorkspace& workspace) {
  Vector6 residual = problem.pseudo_state;
  for (std::size_t k = 0; k < workspace.solution.count; ++k) {
    const Impulse& impulse = workspace.solution.impulses[k];
    residual -= workspace.effects[impulse.time_index] * impulse.dv;
  }
  return residual.norm() / problem.pseudo_state.norm();
}

// CVXOPT stops at a relative gap of 1e-7, 1e-5 where its last steps fail by rounding; its model's central differences
// are good to 1e-7.
constexpr double kReferenceError = 2e-5;

TEST(KoenigReference, EveryRandomProblemConvergesToTheConeSolversOptimum) {
  const auto problems = read_problems();
  ASSERT_EQ(problems.size(), 1200U);
  const auto workspace = std::make_unique<KoenigDamicoWorkspace>();
  accuracy::Largest most_rounds, most_steps, worst_residual, worst_excess;
  for (std::size_t k = 0; k < problems.size(); ++k) {
    SCOPED_TRACE("problem " + std::to_string(k));
    const auto& [problem, settings, optimum] = problems[k];
    const auto plan = solve_koenig_damico(problem, settings, *workspace);
    ASSERT_TRUE(plan.ok()) << static_cast<int>(plan.status());
    const PrimerSolution& solution = workspace->solution;
    EXPECT_LE(plan.value().count, kMaxImpulses);
    EXPECT_GE(solution.cost, optimum * (1.0 - kReferenceError));
    EXPECT_LE(solution.cost, optimum * (1.0 + settings.primer.cost_tolerance + kReferenceError));
    EXPECT_LE(solution.lower_bound, optimum * (1.0 + kReferenceError));
    EXPECT_LT(relative_residual(problem, *workspace), 1e-9);
    most_rounds.add(solution.rounds);
    most_steps.add(solution.newton_steps);
    worst_residual.add(relative_residual(problem, *workspace));
    worst_excess.add(solution.cost / optimum - 1.0);
  }
  RecordProperty("most_rounds", std::to_string(most_rounds));
  RecordProperty("most_newton_steps", std::to_string(most_steps));
  RecordProperty("worst_residual", std::to_string(worst_residual));
  RecordProperty("worst_excess", std::to_string(worst_excess));
  std::printf("rounds <= %.0f, Newton steps <= %.0f, residual <= %.1e, cost above the optimum <= %.2e\n",
              most_rounds.value, most_steps.value, worst_residual.value, worst_excess.value);
}

}  // namespace
}  // namespace vbar::fsw::control
