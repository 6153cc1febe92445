#pragma once
// The cycle counter has 32 bits: 6 seconds. The global timer, which runs at half the processor clock, determines the
// number of overflows.

#include <cstdint>

namespace vbar::boards::zynq7000 {

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
