#pragma once
// Keys of GNSS: receivers, what they are to the flight software, the sky above them.

#include <string>
#include <vector>

#include "host_sim/mission/mission.h"
#include "host_sim/mission/table_reader.h"

namespace vbar::mission {

/// [spacecraft.sensors.gnss]. `names`: of all spacecraft.
GnssSensor read_gnss_sensor(const TableReader& section, const std::string& spacecraft,
                            const std::vector<std::string>& names);

/// [links.crosslink], without the link's own keys.
void read_crosslink_silence(const TableReader& section, Mission& mission);

}  // namespace vbar::mission
