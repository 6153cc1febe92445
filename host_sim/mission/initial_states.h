#pragma once
// Where the spacecraft are when a mission starts.

#include <vector>

#include "fsw/core/result.h"
#include "host_sim/mission/mission.h"

namespace vbar::mission {

/// ECI state at the epoch of a spacecraft given by elements. The status of the conversion if it fails.
[[nodiscard]] fsw::Result<fsw::orbit::CartesianState> state_at_epoch(const OrbitByElements& orbit);

/// ECI state at the start of a spacecraft given by the mean ROE of a waypoint, from the state of the spacecraft it
/// refers to at the start (propagated there if the mission starts after the epoch). ROE are metres over the mission's
/// reference a. kInvalidArgument if the mission has no such waypoint; the status of a conversion that fails.
[[nodiscard]] fsw::Result<fsw::orbit::CartesianState> state_at_waypoint(const Mission& mission,
                                                                        const OrbitByWaypoint& orbit,
                                                                        const fsw::orbit::CartesianState& reference);

}  // namespace vbar::mission
