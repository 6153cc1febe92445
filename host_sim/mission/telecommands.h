#pragma once
// What a mission telecommands to its flight software at the start, as messages of the packet contract.

#include "fsw/packets/messages.h"
#include "host_sim/mission/mission.h"
#include "host_sim/truth/earth/earth_orientation.h"

namespace vbar::mission {

/// All waypoints of the mission; those that are past at the start are in it too, and the flight software passes over
/// them. A mission has at most kMaxWaypoints of them (the loader sees to it).
[[nodiscard]] vbar::waypoint_table waypoint_table_of(const Mission& mission);

[[nodiscard]] vbar::gnc_configuration gnc_configuration_of(const Mission& mission);

/// `orientation`: the Earth's at the start, as the ground predicts it. Antennas are the nominal ones of the spacecraft
/// that flies and its GNSS partner.
[[nodiscard]] vbar::navigation_configuration navigation_configuration_of(
    const Mission& mission, const Spacecraft& servicer, const truth::EarthOrientationSeries& orientation);

[[nodiscard]] vbar::mode_command mode_command_of(const Mission& mission);

}  // namespace vbar::mission
