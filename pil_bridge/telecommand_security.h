#pragma once
// The host's side of the authentication of telecommands (fsw/packets/security_trailer.h).

#include <cstdint>
#include <memory>
#include <string>

#include "fsw/packets/security_trailer.h"
#include "pil_bridge/flight_computer.h"

namespace vbar::pil {

/// The key in `file`, 64 hexadecimal digits, with the sequence number of this instant. Throws FlightComputerError with
/// one sentence if the file cannot be read, has another content, or is accessible to others than its owner. The file
/// is not among the data files of a run, whose names and checksums a run folder states.
fsw::packets::TelecommandSecurity read_telecommand_security(const std::string& file);

/// Adds a trailer to every telecommand for `computer`: to copies of the packets of a step, so that a log, and hashes of
/// a run, are those of a run without. The first sequence number exceeds that of `security`; each later one is that of
/// its instant by the clock of this computer, or the next one if that is greater.
std::unique_ptr<FlightComputer> make_authenticated(std::unique_ptr<FlightComputer> computer,
                                                   const fsw::packets::TelecommandSecurity& security);

}  // namespace vbar::pil
