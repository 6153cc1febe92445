#pragma once
// From a mission's words to its sensors and actuators.

#include <filesystem>
#include <memory>
#include <vector>

#include "host_sim/mission/mission.h"
#include "host_sim/twins/actuator.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::app {

/// What the flight software of `servicer` hears: its navigation sensor, or its own and its partner's GNSS receivers.
/// Throws what a recorded log and GNSS data throw.
std::vector<std::unique_ptr<twins::PacketSource>> make_sensors(const mission::Mission& mission,
                                                               const mission::Spacecraft& servicer,
                                                               const std::filesystem::path& data_directory);

/// `spacecraft` must have a thruster.
std::unique_ptr<twins::Actuator> make_thruster(const mission::Mission& mission, const mission::Spacecraft& spacecraft);

}  // namespace vbar::app
