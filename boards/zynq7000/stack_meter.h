#pragma once
// How deep the stack of flight code and interrupt handlers has ever been: startup.S paints it, this looks for the
// paint.

#include <cstdint>

namespace vbar::boards::zynq7000 {

/// Bytes used at most since start-up. A word that was used and holds the paint's value counts as unused: off by a few
/// bytes at worst.
std::uint32_t stack_high_water();

}  // namespace vbar::boards::zynq7000
