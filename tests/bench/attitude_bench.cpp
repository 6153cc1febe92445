// One orbit of attitude: torque-free, and under gravity gradient on a circular orbit.

#include <cmath>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "host_sim/truth/attitude/gravity_gradient_torque.h"
#include "host_sim/truth/attitude/rigid_body.h"

namespace {

using vbar::fsw::Matrix3;
using vbar::fsw::Vector3;
namespace truth = vbar::truth;

constexpr double kGm = 3.986004415e14;
constexpr double kRadius = 7078e3;
constexpr double kOrbit_s = 5926.0;
constexpr double kTolerance = 1e-12;  // a mission's usual one
const Matrix3 kInertia = Vector3(2.685703125, 3.458072723298021, 3.106463735035312).asDiagonal();
const truth::AttitudeState kOneDegreeASecond{Eigen::Quaterniond::Identity(), {0.010, -0.010, 0.010}};

truth::ForceInput circular_orbit(double t) {
  const double n = std::sqrt(kGm / (kRadius * kRadius * kRadius));
  truth::ForceInput input;
  input.seconds = t;
  input.position_eci = kRadius * Vector3(std::cos(n * t), std::sin(n * t), 0.0);
  return input;
}

void one_orbit(benchmark::State& state, bool with_torque) {
  std::int64_t steps = 0;
  for (auto _ : state) {
    std::vector<std::unique_ptr<truth::Torque>> torques;
    if (with_torque) torques.push_back(std::make_unique<truth::GravityGradientTorque>(kGm, kInertia));
    truth::RigidBody body(kInertia, std::move(torques), circular_orbit, kTolerance, 0.0, kOneDegreeASecond);
    body.advance_to(kOrbit_s);
    benchmark::DoNotOptimize(body.state_at(kOrbit_s));
    steps = body.statistics().accepted_steps;
  }
  state.counters["steps"] = static_cast<double>(steps);
}

BENCHMARK_CAPTURE(one_orbit, torque_free, false)->Name("attitude/vbar/one_orbit_tumble")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(one_orbit, gravity_gradient, true)
    ->Name("attitude/vbar/one_orbit_gravity_gradient")
    ->Unit(benchmark::kMillisecond);

}  // namespace
