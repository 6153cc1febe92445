#include "emulators/grand/receiver/measurements.h"

#include <cmath>

#include "host_sim/twins/gnss/point_solution.h"
#include "host_sim/twins/gnss/signal_path.h"

namespace vbar::grand::bench {
namespace {

using fsw::Vector3;
using fsw::gnss::kSpeedOfLight;
using twins::gnss::AntennaState;
using twins::gnss::PointResidual;
using twins::gnss::PointSolution;

constexpr int kIterations = 12;
constexpr double kConverged_m = 1e-3;
constexpr double kMinRadius_m = 6.3e6;
constexpr double kMaxRadius_m = 15e6;

/// Below the mean direction of the satellites.
Vector3 guess(const std::vector<SolutionInput>& input, fsw::GpsTime reading) {
  Vector3 sum = Vector3::Zero();
  for (const SolutionInput& one : input)
    sum += twins::gnss::satellite_state(*one.ephemeris, reading).position_ecef.normalized();
  return sum.norm() > 1e-3 ? Vector3(6.8e6 * sum.normalized()) : Vector3(6.8e6, 0.0, 0.0);
}

PointResidual residual_of(const SolutionInput& one, const AntennaState& antenna) {
  const twins::gnss::SignalPath predicted = twins::gnss::broadcast_path(*one.ephemeris, antenna);
  PointResidual residual;
  residual.line_of_sight = predicted.line_of_sight;
  residual.code_m = one.pseudorange_m - predicted.range_m +
                    kSpeedOfLight * (predicted.satellite_clock_s - one.ephemeris->group_delay_s);
  residual.range_rate_mps =
      one.range_rate_mps - predicted.range_rate_mps + kSpeedOfLight * predicted.satellite_clock_drift;
  residual.code_sigma_m = one.sigma_m;
  return residual;
}

}  // namespace

std::optional<OwnSolution> solve_own(const std::vector<SolutionInput>& input, fsw::GpsTime reading,
                                     const std::optional<Vector3>& start) {
  if (input.size() < 4) return std::nullopt;
  AntennaState antenna;
  antenna.time = reading;
  antenna.position_ecef = start ? *start : guess(input, reading);
  std::vector<PointResidual> residuals(input.size());
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (std::size_t k = 0; k < input.size(); ++k) residuals[k] = residual_of(input[k], antenna);
    const std::optional<PointSolution> step = twins::gnss::solve_point(residuals);
    if (!step) return std::nullopt;
    antenna.position_ecef += step->position_error_ecef;
    antenna.velocity_ecef += step->velocity_error_ecef;
    const double moved_s = std::abs(step->clock_offset_s + antenna.offset_s);
    antenna.offset_s = -step->clock_offset_s;
    const double radius = antenna.position_ecef.norm();
    if (!(radius > 1e5 && radius < 1e9)) return std::nullopt;
    if (step->position_error_ecef.norm() > kConverged_m || moved_s * kSpeedOfLight > kConverged_m ||
        step->velocity_error_ecef.norm() > kConverged_m)
      continue;
    if (radius < kMinRadius_m || radius > kMaxRadius_m) return std::nullopt;
    return OwnSolution{.position_ecef = antenna.position_ecef,
                       .velocity_ecef = antenna.velocity_ecef,
                       .position_sigma_m = step->position_sigma,
                       .velocity_sigma_mps = step->velocity_sigma,
                       .clock_offset_s = step->clock_offset_s,
                       .clock_drift = step->clock_drift,
                       .clock_sigma_s = step->clock_sigma_s,
                       .satellites = static_cast<int>(step->satellites)};
  }
  return std::nullopt;
}

}  // namespace vbar::grand::bench
