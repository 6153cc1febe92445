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

// The cycle counter has 32 bits: 6 seconds. The global timer, which runs at half the processor clock, determines the
// number of overflows.

/// Returns the number of cycles that is congruent to `low` modulo 2^32 and nearest to `estimate`.
constexpr std::uint64_t nearest_cycle_count(std::uint32_t low, std::uint64_t estimate) {
  constexpr std::uint64_t kTurn = 1ULL << 32;
  const std::uint64_t same_turn = (estimate & ~(kTurn - 1U)) | low;
  if (same_turn > estimate && same_turn - estimate > kTurn / 2U && same_turn >= kTurn) {
    return same_turn - kTurn;
  }
  if (same_turn < estimate && estimate - same_turn > kTurn / 2U) {
    return same_turn + kTurn;
  }
  return same_turn;
}

}  // namespace vbar::boards::zynq7000
