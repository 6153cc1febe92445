#pragma once
// Values of 16 bits in slots of DMX512: two adjacent slots, the coarse one first.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace vbar::tron::sacn {

/// Stores the values in `slots` from number `start_slot` (from 1); `slots` has to be long enough.
inline void store_values(std::span<const std::uint16_t> values, int start_slot, std::vector<std::uint8_t>& slots) {
  auto at = static_cast<std::size_t>(start_slot - 1);
  for (const std::uint16_t value : values) {
    slots[at++] = static_cast<std::uint8_t>(value >> 8U);
    slots[at++] = static_cast<std::uint8_t>(value & 0xFFU);
  }
}

/// Loads values from slots; slots that a packet does not have are zero.
inline void load_values(std::span<const std::uint8_t> slots, int start_slot, std::span<std::uint16_t> values) {
  auto at = static_cast<std::size_t>(start_slot - 1);
  const auto next = [&]() -> unsigned { return at < slots.size() ? slots[at++] : 0U; };
  for (std::uint16_t& value : values) {
    const unsigned coarse = next();
    value = static_cast<std::uint16_t>((coarse << 8U) | next());
  }
}

}  // namespace vbar::tron::sacn
