#pragma once
// Emulated OEM628 (../receiver) as the receiver of a vehicle.

#include "hil_drivers/grand/bench/generator/receiver_end.h"
#include "hil_drivers/grand/bench/generator/scenario.h"
#include "hil_drivers/grand/bench/receiver/receiver.h"

namespace vbar::grand::bench {

/// Returns a receiver with the ports and commands of an OEM628, as the receiver of a vehicle.
std::unique_ptr<ReceiverEnd> receiver_end(Receiver receiver);

/// Returns a factory of receivers with the settings of the scenario's vehicles.
ReceiverFactory oem628_receivers(const Scenario& scenario);

}  // namespace vbar::grand::bench
