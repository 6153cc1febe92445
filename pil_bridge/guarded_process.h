#pragma once
// A flight computer in a child process, so that foreign flight software that crashes or never returns ends neither the
// run's record nor the program. The price is two messages over a socket for each step; vbar's own flight software,
// whose loops are bounded, therefore stays in the process of the simulation.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "pil_bridge/flight_computer.h"

namespace vbar::pil {

/// Calls `make` in a child process and hands every step over to what it makes. `name` is that of the flight software in
/// messages. Throws FlightComputerError, here and from step(): what was thrown there, or that the software crashed or
/// did not return within `step_limit`, or within a second of a signal to this process. The child has `memory_bytes`
/// beside what it shares with this process; 0: no limit. Processes that it leaves behind in its group are ended with
/// it.
std::unique_ptr<FlightComputer> make_guarded(const std::function<std::unique_ptr<FlightComputer>()>& make,
                                             const std::string& name, std::chrono::milliseconds step_limit,
                                             std::uint64_t memory_bytes = 0);

}  // namespace vbar::pil
