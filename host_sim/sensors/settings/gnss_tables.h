#pragma once
// Tables that a mission file and the scenario file of an emulated GNSS testbed share: satellites, and which of their
// signals reach an antenna.

#include "host_sim/mission/table_reader.h"
#include "host_sim/twins/gnss/constellation.h"
#include "host_sim/twins/gnss/gnss_settings.h"

namespace vbar::sensors {

// A missing key keeps the value that the settings have. Throw MissionError. The caller finishes the table...
void read_visibility(const mission::TableReader& section, twins::gnss::VisibilitySettings& settings);
void read_link_budget(const mission::TableReader& section, twins::gnss::LinkBudgetSettings& settings);
// ... except this one.
void read_constellation(const mission::TableReader& section, twins::gnss::ConstellationSettings& settings);

}  // namespace vbar::sensors
