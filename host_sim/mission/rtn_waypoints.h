#pragma once
// Waypoints that are stated as position and velocity in RTN, converted to the mean relative orbital elements that the
// flight software flies to.

#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::mission {

/// Sets a_roe_m of each waypoint with target_rtn: the target, which does not manoeuvre, is where mean elements and J2
/// bring it by that time, and the servicer stands so that the target has that position and velocity in its RTN. Throws
/// MissionError that names the waypoint, if the target's orbit is that of a file or does not exist.
void place_rtn_waypoints(const TableReader& document, Mission& mission);

}  // namespace vbar::mission
