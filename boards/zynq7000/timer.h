#pragma once
// Two counters of the Cortex-A9: the global timer, which always runs, and the cycle counter of the performance
// monitoring unit, which counts on silicon and reads zero on the emulator.

#include <cstdint>

#include "boards/common/flight_executive.h"

namespace vbar::boards::zynq7000 {

/// Starts both counters and detects whether the cycle counter runs.
void timers_initialize();

/// Returns the global timer. Half the processor clock on silicon (about 333 MHz), 100 MHz on the emulator.
std::uint64_t global_timer();

/// Returns a span of the global timer that lasts at least `milliseconds` at any rate; up to 3.5 times that on the
/// emulator.
constexpr std::uint64_t timer_span_ms(std::uint64_t milliseconds) {
  return milliseconds * 350'000U;
}

/// Returns the unit of cost_counter().
CounterUnit cost_counter_unit();

/// Returns processor cycles, or ticks of the emulator's global timer. Differences are valid over intervals without
/// sleep.
std::uint64_t cost_counter();

}  // namespace vbar::boards::zynq7000
