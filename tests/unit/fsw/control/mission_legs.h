#pragma once
// The close legs of the rendezvous as control problems, from the mission's waypoint table and servicer orbit.

#include "fsw/control/plan.h"
#include "fsw/orbit/propagate.h"

namespace vbar::fsw::control {

/// Mean elements of the servicer at the mission's epoch: first-order Brouwer mean of the osculating elements
/// (7087.30 km, 0.0015, -4.17e-8, 98.18 deg, -90 deg, -0.69 deg).
inline orbit::QnsElements servicer_mean_at_epoch() {
  constexpr double kDegree = 3.14159265358979323846 / 180.0;
  return {.a = 7078138.944,
          .ex = 0.00104134174,
          .ey = 1.5923745e-5,
          .i = 98.1853293 * kDegree,
          .raan = -90.0001291 * kDegree,
          .u = -0.6886792 * kDegree};
}

/// A leg of `duration_s` from `start_s` after the epoch; `change_m` is a times the pseudo-state.
inline ControlProblem mission_leg(std::int64_t start_s, std::int64_t duration_s, const Vector6& change_m) {
  const GpsTime epoch{1'000'000'000'000'000'000};
  ControlProblem problem;
  problem.start = epoch + duration_of_seconds(start_s);
  problem.arrival = problem.start + duration_of_seconds(duration_s);
  problem.servicer_mean = orbit::propagate_secular(servicer_mean_at_epoch(), static_cast<double>(start_s));
  problem.pseudo_state = change_m / problem.servicer_mean.a;
  return problem;
}

/// Waypoint 8 (39 h) to 9 (40 h), and 9 to 10 (41.25 h): what the drift leaves to do, servicer never burned.
inline ControlProblem leg_8_to_9() {
  return mission_leg(39 * 3600, 3600, Vector6(0.5, 0.145713, 0.995478, -1.999991, 2.0, -1.001241));
}
inline ControlProblem leg_9_to_10() {
  return mission_leg(40 * 3600, 4500, Vector6(0.0, -1.512391, 3e-6, 0.002818, -1.0, -0.012331));
}

}  // namespace vbar::fsw::control
