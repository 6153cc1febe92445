#pragma once
// Resets of the processing system by the watchdog: the record of the flight before, and the reset itself.

#include "boards/zynq7000/flight_record.h"

namespace vbar::boards::zynq7000 {

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
