#pragma once
// Keys of the camera of a spacecraft.

#include <string>
#include <vector>

#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::mission {

/// [spacecraft.sensors.camera]. `own`: the spacecraft's name; `names`: of all spacecraft; of the mission general keys
/// must have been read.
CameraSensor read_camera(const TableReader& section, const std::string& own, const std::vector<std::string>& names,
                         const Mission& mission);

}  // namespace vbar::mission
