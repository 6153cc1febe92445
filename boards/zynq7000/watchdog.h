#pragma once
// Private watchdog of the first core: it resets the processor unless it is fed in time. The main loop feeds it: one
// cycle of the loop handles one frame and at most one step.
//
// On silicon the watchdog requests the reset itself, which no software can prevent. The emulator models the counter but
// not the request; there an interrupt handler, which flight software does not mask, resets the processor through the
// SLCR.

#include <cstdint>

#include "boards/zynq7000/flight_record.h"

namespace vbar::boards::zynq7000 {

/// Starts the watchdog, or changes the time in which it must be fed, and feeds it. `span` is in ticks of the global
/// timer, at most kWatchdogMaxSpan.
void watchdog_start(std::uint64_t span);
inline constexpr std::uint64_t kWatchdogMaxSpan = std::uint64_t{256} << 32;

void watchdog_feed();

/// Marks the beginning of a wait for an interrupt; the next function marks its end. On silicon the core's timer ends a
/// wait in good time, and the watchdog continues to count. On the emulator, where time would rush from one expiry of a
/// timer to the next during a wait, the watchdog stands still.
void watchdog_before_wait();
void watchdog_after_wait();

// Resets of the processing system by the watchdog: the record of the flight before, and the reset itself.

/// State that the image finds at its start.
struct Restart {
  bool by_watchdog = false;
  bool has_record = false;  ///< there is a record of the flight that the watchdog ended
  FlightRecord record;
};

/// Returns the state before. To be called once, at start-up.
Restart find_restart();

/// Keeps the record through a reset.
void retain(const FlightRecord& record);

/// Marks the retained record and resets the processing system, where the watchdog cannot do so itself.
[[noreturn]] void reset_by_watchdog();

}  // namespace vbar::boards::zynq7000
