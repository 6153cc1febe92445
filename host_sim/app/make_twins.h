#pragma once
// From a mission's words to its sensors and actuators.

#include <memory>

#include "host_sim/mission/mission.h"
#include "host_sim/twins/actuator.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::app {

/// `spacecraft` must have a navigation sensor. Throws what a recorded log throws.
std::unique_ptr<twins::PacketSource> make_navigation_source(const mission::Mission& mission,
                                                            const mission::Spacecraft& spacecraft);

/// `spacecraft` must have a thruster.
std::unique_ptr<twins::Actuator> make_thruster(const mission::Mission& mission, const mission::Spacecraft& spacecraft);

}  // namespace vbar::app
