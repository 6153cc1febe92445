#include "hil_drivers/optical_stimulator/bench/drift.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host_sim/engine/random_stream.h"

namespace vbar::optical_stimulator::bench {
namespace {

/// In a direction, and towards a scale, drawn from the stream.
Displacement drawn(engine::RandomStream stream, double length_um, double scale_ppm) {
  const double direction = stream.uniform(0.0, 2.0 * std::numbers::pi);
  const double sign = stream.uniform() < 0.5 ? -1.0 : 1.0;
  return {{length_um * std::cos(direction), length_um * std::sin(direction)}, sign * scale_ppm};
}

}  // namespace

Displacement drift_at(const DriftSettings& drift, std::uint64_t seed, std::uint64_t frame) {
  const auto step = static_cast<double>(frame / kDriftStep * kDriftStep);
  const double share = std::min(1.0, step / drift.run_frames);
  const Displacement run = drawn({seed, fmt::format("bench/drift/run/{}", drift.day)}, share * drift.run_shift_um,
                                 share * drift.run_scale_ppm);
  if (drift.day == 0) return run;
  const Displacement day =
      drawn({seed, fmt::format("bench/drift/day/{}", drift.day)}, drift.day_shift_um, drift.day_scale_ppm);
  return {{day.um[0] + run.um[0], day.um[1] + run.um[1]}, day.scale_ppm + run.scale_ppm};
}

}  // namespace vbar::optical_stimulator::bench
