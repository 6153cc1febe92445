#pragma once
// Initial telecommands of a mission to its flight software that do not depend on its sensors, as messages of the packet
// contract. (The parameters of guidance are such a message in the mission.)

#include "fsw/packets/messages.h"
#include "host_sim/mission/mission.h"

namespace vbar::mission {

/// Returns all waypoints of the mission, including those that have passed at the start, which the flight software
/// skips. A mission has at most kMaxWaypoints of them (checked by the loader).
[[nodiscard]] vbar::waypoint_table waypoint_table_of(const Mission& mission);

[[nodiscard]] vbar::mode_command mode_command_of(const Mission& mission);

}  // namespace vbar::mission
