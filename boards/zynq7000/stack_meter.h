#pragma once
// Stack high-water mark of flight code and interrupt handlers: startup.S paints the stack, and the paint is searched
// here.

#include <cstdint>

namespace vbar::boards::zynq7000 {

/// Returns the maximum number of bytes used since start-up. A used word with the value of the paint counts as unused:
/// an error of a few bytes at most.
std::uint32_t stack_high_water();

}  // namespace vbar::boards::zynq7000
