#pragma once
// gnss-sdr behind the serial lines of the emulator: ports, commands and logs are those of the emulated receiver, the
// measurements are gnss-sdr's.

#include <filesystem>

#include "hil_drivers/grand/bench/generator/receiver_end.h"
#include "hil_drivers/grand/bench/generator/scenario.h"

namespace vbar::grand::bench {

/// Returns a factory of receivers for the scenario's vehicles; each keeps its files in DIRECTORY/<vehicle>.gnss_sdr
/// while it exists. Throws std::invalid_argument, one sentence, if the scenario's pace is not real time.
ReceiverFactory gnss_sdr_receivers(const Scenario& scenario, const std::filesystem::path& directory);

}  // namespace vbar::grand::bench
