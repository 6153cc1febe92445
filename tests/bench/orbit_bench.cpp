// Cost of the orbit and safety functions that every flight step calls.

#include <benchmark/benchmark.h>

#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/orbit/roe.h"
#include "fsw/orbit/rtn.h"
#include "fsw/safety/collision_probability.h"
#include "fsw/safety/passive_safety.h"

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
