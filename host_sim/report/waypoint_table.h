#pragma once
// The waypoint table of a run for the console: how each waypoint was met and what it cost.

#include <string>

#include "host_sim/report/run_record.h"

namespace vbar::report {

/// Aligned columns, units in the head, a line a waypoint and one for the whole run. Ends in a line break.
[[nodiscard]] std::string waypoint_table(const RunRecord& record);

}  // namespace vbar::report
