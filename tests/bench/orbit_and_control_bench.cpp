// Cost of the orbit and safety functions that every flight step calls.

#include <memory>

#include <benchmark/benchmark.h>

#include "fsw/control/arrival.h"
#include "fsw/control/koenig_damico.h"
#include "fsw/control/least_squares.h"
#include "fsw/control/leg.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "fsw/safety/collision_probability.h"
#include "fsw/safety/passive_safety.h"
#include "tests/unit/fsw/control/legs.h"

namespace {

namespace control = vbar::fsw::control;
namespace orbit = vbar::fsw::orbit;
namespace safety = vbar::fsw::safety;
using vbar::fsw::GpsTime;
using vbar::fsw::Matrix3;
using vbar::fsw::Vector3;
using vbar::fsw::Vector6;

constexpr double kHorizon = 6000.0;  // s, one orbit

/// The mission's servicer.
orbit::QnsElements servicer() {
  return {.a = 7078138.9, .ex = 1.0413e-3, .ey = 1.59e-5, .i = 1.71366, .raan = -1.5708, .u = -0.01202};
}

/// Waypoint 1 of the mission: 50 km behind, e/i separated by 1 km.
Vector6 relative_orbit() {
  Vector6 roe;
  roe << -87.0, -50000.0, 0.0, 1000.0, 0.0, 1000.0;
  return roe / 7078138.9;
}

void mean_from_osculating(benchmark::State& state) {
  orbit::QnsElements osculating = orbit::osculating_from_mean(servicer()).value();
  for (auto _ : state) {
    osculating.u += 0.01;
    benchmark::DoNotOptimize(orbit::mean_from_osculating(osculating));
  }
}
BENCHMARK(mean_from_osculating)->Name("mean_from_osculating/vbar");

void cartesian_round_trip(benchmark::State& state) {
  orbit::QnsElements q = servicer();
  for (auto _ : state) {
    q.u += 0.01;
    benchmark::DoNotOptimize(orbit::qns_from_cartesian(orbit::cartesian_from_qns(q).value()));
  }
}
BENCHMARK(cartesian_round_trip)->Name("cartesian_round_trip/vbar");

void transition(benchmark::State& state) {
  const orbit::QnsElements chief = servicer();
  double tau = 0.0;
  for (auto _ : state) benchmark::DoNotOptimize(orbit::roe_transition_j2(chief, tau += 1.0));
}
BENCHMARK(transition)->Name("roe_transition_j2/vbar");

void control_matrix(benchmark::State& state) {
  orbit::QnsElements chief = servicer();
  for (auto _ : state) {
    chief.u += 0.01;
    benchmark::DoNotOptimize(orbit::roe_control_matrix(chief));
  }
}
BENCHMARK(control_matrix)->Name("roe_control_matrix/vbar");

void exact_relative_state(benchmark::State& state) {
  orbit::QnsElements chief = servicer();
  const Vector6 roe = relative_orbit();
  for (auto _ : state) {
    chief.u += 0.01;
    benchmark::DoNotOptimize(orbit::relative_state_from_mean_roe(chief, roe));
  }
}
BENCHMARK(exact_relative_state)->Name("relative_state_from_mean_roe/vbar");

void coast(benchmark::State& state) {
  const orbit::CartesianState start = orbit::cartesian_from_qns(servicer()).value();
  for (auto _ : state) benchmark::DoNotOptimize(orbit::propagate_j2(start, static_cast<double>(state.range(0))));
}
BENCHMARK(coast)->Name("propagate_j2/vbar")->Arg(10)->Arg(600);

void drift(benchmark::State& state) {
  orbit::QnsElements chief = servicer();
  const Vector6 roe = relative_orbit();
  for (auto _ : state) {
    chief.u += 0.01;
    benchmark::DoNotOptimize(safety::assess_drift(chief, roe, kHorizon));
  }
}
BENCHMARK(drift)->Name("assess_drift/vbar/1_orbit");

void plan(benchmark::State& state) {
  const GpsTime start{995000000'000'000'000};
  control::Plan burns;
  for (std::int64_t k = 0; k < state.range(0); ++k) {
    burns.burns[burns.count++] = {.time = start + vbar::fsw::duration_of_seconds(600 * k),
                                  .dv_rtn = Vector3(0.0, 1e-3, 1e-3)};
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(safety::assess_plan(start, servicer(), relative_orbit(), burns, {.horizon = kHorizon}));
  }
}
BENCHMARK(plan)->Name("assess_plan/vbar")->Arg(4)->Arg(32);

void probability(benchmark::State& state) {
  const Matrix3 covariance = Vector3(1.0, 16.0, 2.0).asDiagonal();
  for (auto _ : state) benchmark::DoNotOptimize(safety::collision_probability(Vector3(3.0, 8.0, 1.0), covariance, 2.0));
}
BENCHMARK(probability)->Name("collision_probability/vbar/3d");

}  // namespace

// The optimising solvers on a horizon of three orbits: the case of the name's number of candidate times or burns.

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

// The closed-form solver and the decisions around it, on leg 0 to 1 of the mission: 75 to 50 km in 6 h.

namespace {

namespace mission = orbit::mission;

control::LegSituation first_leg() {
  control::LegSituation situation;
  situation.orbits = {
      {}, mission::kServicerMean, orbit::qns_from_roe(mission::kServicerMean, mission::kWaypoints[0].roe())};
  situation.earliest_burn = GpsTime{} + duration_of_seconds(10);
  situation.waypoint = {GpsTime{} + duration_of_seconds(21600), mission::kWaypoints[1].roe()};
  return situation;
}

/// The linear problem alone.
void leg(benchmark::State& state) {
  const control::ControlProblem problem = control::legs::problem(control::legs::kFarLegs[0]);
  for (auto _ : state) benchmark::DoNotOptimize(control::solve_closed_form(problem));
}

/// A plan from nothing, nonlinear prediction and corrections included.
void replan(benchmark::State& state) {
  const control::LegSituation situation = first_leg();
  for (auto _ : state) benchmark::DoNotOptimize(control::decide_leg(situation, {}, {}));
}

/// The usual decision: predict the arrival of three burns, find it good.
void keep(benchmark::State& state) {
  const control::LegSituation situation = first_leg();
  const control::Plan plan = control::decide_leg(situation, {}, {}).value().plan;
  for (auto _ : state) benchmark::DoNotOptimize(control::decide_leg(situation, plan, {}));
}

/// The next usual one: corrected burns.
void correct(benchmark::State& state) {
  control::LegSituation situation = first_leg();
  const control::Plan plan = control::decide_leg(situation, {}, {}).value().plan;
  situation.waypoint.roe[1] += 10.0 / mission::kReferenceA;
  for (auto _ : state) benchmark::DoNotOptimize(control::decide_leg(situation, plan, {}));
}

BENCHMARK(leg)->Name("closed_form/vbar/leg")->Unit(benchmark::kMicrosecond);
BENCHMARK(replan)->Name("closed_form/vbar/replan")->Unit(benchmark::kMicrosecond);
BENCHMARK(keep)->Name("closed_form/vbar/keep")->Unit(benchmark::kMicrosecond);
BENCHMARK(correct)->Name("closed_form/vbar/correct")->Unit(benchmark::kMicrosecond);

}  // namespace
