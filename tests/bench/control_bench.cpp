// The optimising solvers on a horizon of three orbits: the case of the name's number of candidate times or burns.

#include <memory>

#include <benchmark/benchmark.h>

#include "fsw/control/arrival.h"
#include "fsw/control/koenig_damico.h"
#include "fsw/control/least_squares.h"

namespace {

using namespace vbar::fsw;

/// Three orbits at 30 s are 594 candidate times. The change is that between waypoints 8 and 9 of the rendezvous, m.
control::ControlProblem three_orbits() {
  control::ControlProblem problem;
  problem.start = {1'000'000'000'000'000'000};
  problem.arrival = problem.start + duration_of_seconds(17790);
  problem.servicer_mean = {7078138.944, 0.00104134174, 1.5923745e-5, 1.71365730, -1.57079858, -2.13591030};
  problem.pseudo_state << 0.5, 0.145713, 0.995478, -1.999991, 2.0, -1.001241;
  problem.pseudo_state /= problem.servicer_mean.a;
  return problem;
}

void koenig_damico(benchmark::State& state, std::int64_t grid_step_s) {
  const auto workspace = std::make_unique<control::KoenigDamicoWorkspace>();
  control::KoenigDamicoSettings settings;
  settings.grid_step = duration_of_seconds(grid_step_s);
  const auto problem = three_orbits();
  for (auto _ : state) benchmark::DoNotOptimize(control::solve_koenig_damico(problem, settings, *workspace));
  state.counters["newton_steps"] = workspace->solution.newton_steps;
  state.counters["rounds"] = workspace->solution.rounds;
}
BENCHMARK_CAPTURE(koenig_damico, , 30)->Name("koenig_damico/vbar/600");
BENCHMARK_CAPTURE(koenig_damico, , 180)->Name("koenig_damico/vbar/100");

/// The part of koenig_damico that builds the grid.
void arrival_effects(benchmark::State& state) {
  const auto problem = three_orbits();
  for (auto _ : state) {
    for (std::int64_t t = 0; t < 600; ++t) {
      const GpsTime burn = problem.start + duration_of_seconds(29 * t);
      benchmark::DoNotOptimize(control::arrival_effect(problem.servicer_mean, problem.start, burn, problem.arrival));
    }
  }
}
BENCHMARK(arrival_effects)->Name("arrival_effect/vbar/600");

void least_squares(benchmark::State& state) {
  const auto problem = three_orbits();
  for (auto _ : state) benchmark::DoNotOptimize(control::solve_least_squares(problem));
}
BENCHMARK(least_squares)->Name("least_squares/vbar/3");

}  // namespace
