#pragma once
// The words of the GPS LNAV message as they are transmitted: parity of IS-GPS-200N 20.3.5.2, table 20-XIV.

#include <array>
#include <cstdint>

#include "host_sim/twins/gnss/navigation_message.h"

namespace vbar::twins::gnss {

/// Ten words of 30 bits, the first transmitted in bit 29.
using TransmittedSubframe = std::array<std::uint32_t, 10>;

/// Returns the word of 30 bits after `previous` (of which D29 and D30 are used) that carries the 24 bits of `data`.
std::uint32_t lnav_word(std::uint32_t data, std::uint32_t previous);

/// Returns the subframe with parity. The last two data bits of words 2 and 10 are solved so that D29 and D30 are zero,
/// so that subframes do not depend on each other.
TransmittedSubframe lnav_transmitted(const Subframe& subframe);

}  // namespace vbar::twins::gnss
