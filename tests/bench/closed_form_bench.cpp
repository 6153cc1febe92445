// The closed-form solver and the decisions around it, on leg 0 to 1 of the mission: 75 to 50 km in 6 h.

#include <benchmark/benchmark.h>

#include "fsw/control/leg.h"
#include "fsw/orbit/roe.h"
#include "tests/unit/fsw/control/legs.h"

namespace {

using namespace vbar::fsw;
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
