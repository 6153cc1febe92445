#pragma once
// Makes the twin of the thruster of a mission file.

#include <memory>

#include "host_sim/mission/mission.h"
#include "host_sim/twins/actuator.h"

namespace vbar::app {

/// `spacecraft` must have a thruster.
std::unique_ptr<twins::Actuator> make_thruster(const mission::Mission& mission, const mission::Spacecraft& spacecraft);

}  // namespace vbar::app
