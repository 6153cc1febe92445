#pragma once
// Stack of known place, size and content for the flight software, so that its depth can be measured.

#include <cstddef>
#include <cstdint>

namespace vbar::boards::posix {

inline constexpr std::size_t kFlightStackBytes = std::size_t{1024} * 1024;

/// Runs `function(context)` to its end on a painted stack with a guard page below. Returns false if the system does not
/// allow it. One call at a time.
bool run_on_measured_stack(void (*function)(void*), void* context);

/// Returns the number of bytes of that stack ever used by `function` and the functions it called. To be called from
/// within.
std::uint32_t stack_high_water();

}  // namespace vbar::boards::posix
