#pragma once
// Verdict on a flown mission: its goals, and the limits that it states, against the record of the run.

#include <optional>
#include <string>

#include "host_sim/mission/mission.h"
#include "host_sim/report/run_record.h"
#include "host_sim/report/verdict.h"

namespace vbar::app {

/// Waypoints, keep-out radii and mode that the mission commands, without its limits.
[[nodiscard]] report::Goals goals_of(const mission::Mission& mission);

/// Fills verdict, reason and missed waypoints of a record whose summary says whether the run is complete.
void put_verdict(const mission::Mission& mission, report::RunRecord& record);

/// Flight software that answered no step in a usable way: the sentence that says how many and how; otherwise nothing.
[[nodiscard]] std::optional<std::string> missing_output(const report::FlightOutput& output);

}  // namespace vbar::app
