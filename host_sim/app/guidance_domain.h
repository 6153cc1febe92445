#pragma once
// The orbits that the maneuver planners of the flight software are made for.

#include "fsw/orbit/elements.h"
#include "host_sim/mission/mission.h"

namespace vbar::app {

/// Throws std::runtime_error that names waypoint, planner and its domain if vbar's flight software would plan a leg of
/// an approach on an orbit (state of the servicer at the start, GCRF) outside it, and for a mission that reaches
/// beyond the times of its packets; for any flight software if the orbit has no mean elements, which the record needs.
void check_guidance_domain(const mission::Mission& mission, const mission::Spacecraft& servicer,
                           const fsw::orbit::CartesianState& servicer_state);

}  // namespace vbar::app
