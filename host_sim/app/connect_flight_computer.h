#pragma once
// Makes the flight computer that a mission describes, started and answering.

#include <memory>
#include <optional>

#include "host_sim/io/wired_receiver.h"
#include "host_sim/mission/mission.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::app {

/// The first spacecraft of the mission that has a flight computer. Throws std::runtime_error if none has.
const mission::Spacecraft& flying_spacecraft(const mission::Mission& mission);

/// The library or image that it flies; empty if the flight software is in this program, on a board, or not found.
std::string flight_software_file(const mission::Spacecraft& spacecraft);

/// `receiver`: that is wired to it, if there is one. Throws pil::FlightComputerError.
std::unique_ptr<pil::FlightComputer> connect_flight_computer(
    const mission::Spacecraft& spacecraft, const std::optional<io::WiredReceiver>& receiver = std::nullopt);

}  // namespace vbar::app
