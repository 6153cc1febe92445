#pragma once
// Emulated OEM628 (../receiver) as the receiver of a vehicle.

#include <filesystem>

#include "emulators/grand/generator/scenario.h"
#include "emulators/grand/generator/vehicle.h"
#include "emulators/grand/receiver/receiver.h"

namespace vbar::grand::bench {

/// Returns a receiver with the ports and commands of an OEM628, as the receiver of a vehicle.
std::unique_ptr<ReceiverEnd> receiver_end(Receiver receiver);

/// Returns a factory of receivers with the settings of the scenario's vehicles.
ReceiverFactory oem628_receivers(const Scenario& scenario);

// gnss-sdr behind the serial lines of the emulator: ports, commands and logs are those of the emulated receiver, the
// measurements are gnss-sdr's.

/// Returns a factory of receivers for the scenario's vehicles; each keeps its files in DIRECTORY/<vehicle>.gnss_sdr
/// while it exists. Throws std::invalid_argument, one sentence, if the scenario's pace is not real time.
ReceiverFactory gnss_sdr_receivers(const Scenario& scenario, const std::filesystem::path& directory);

}  // namespace vbar::grand::bench
