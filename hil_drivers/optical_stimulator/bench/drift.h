#pragma once
// Displacement of the display between days and in a session.

#include <array>
#include <cstdint>

#include "hil_drivers/optical_stimulator/bench/bench_settings.h"

namespace vbar::optical_stimulator::bench {

struct Displacement {
  std::array<double, 2> um{};
  double scale_ppm = 0.0;
};

/// Returns the displacement after a number of exposures; constant over kDriftStep of them.
[[nodiscard]] Displacement drift_at(const DriftSettings& drift, std::uint64_t seed, std::uint64_t frame);

inline constexpr std::uint64_t kDriftStep = 64;

}  // namespace vbar::optical_stimulator::bench
