#pragma once
// What a mission telecommands to its flight software at the start, whatever its sensors, as messages of the packet
// contract. (The parameters of guidance are such a message in the mission.)

#include "fsw/packets/messages.h"
#include "host_sim/mission/mission.h"

namespace vbar::mission {

/// All waypoints of the mission; those that are past at the start are in it too, and the flight software passes over
/// them. A mission has at most kMaxWaypoints of them (the loader sees to it).
[[nodiscard]] vbar::waypoint_table waypoint_table_of(const Mission& mission);

[[nodiscard]] vbar::mode_command mode_command_of(const Mission& mission);

}  // namespace vbar::mission
