#pragma once
// The private watchdog of the first core: it resets the processor unless it is fed in time. What it is fed for is the
// main loop: one turn takes one frame and at most one step.
//
// On silicon the watchdog requests the reset itself, which no software can prevent. The emulator models the counter but
// not the request; there an interrupt handler, which flight software does not mask, resets the processor through the
// SLCR.

#include <cstdint>

namespace vbar::boards::zynq7000 {

/// Starts it, or changes the time in which it must be fed, and feeds it. `span`: ticks of the global timer, at most
/// kWatchdogMaxSpan.
void watchdog_start(std::uint64_t span);
inline constexpr std::uint64_t kWatchdogMaxSpan = std::uint64_t{256} << 32;

void watchdog_feed();

/// Between these two the processor waits for an interrupt. On silicon the core's timer ends a wait in good time, and
/// the watchdog counts on. On the emulator, where time would rush from one expiry of a timer to the next during a wait,
/// the watchdog stands still.
void watchdog_before_wait();
void watchdog_after_wait();

}  // namespace vbar::boards::zynq7000
