#pragma once
// Verdict on a flown mission: its goals, and the limits that it states, against the record of the run.

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "host_sim/campaign/case_records.h"
#include "host_sim/mission/mission.h"
#include "host_sim/report/run_record.h"
#include "host_sim/report/verdict.h"
#include "host_sim/simulation/limit_check.h"

namespace vbar::app {

/// Waypoints, keep-out radii and mode that the mission commands, without its limits.
[[nodiscard]] report::Goals goals_of(const mission::Mission& mission);

/// Fills verdict, reason and missed waypoints of a record whose summary says whether the run is complete.
void put_verdict(const mission::Mission& mission, report::RunRecord& record);

/// Flight software that answered no step in a usable way: the sentence that says how many and how; otherwise nothing.
[[nodiscard]] std::optional<std::string> missing_output(const report::FlightOutput& output);

// The limits of a mission against a run, printed one a line.

struct CheckedRun {
  check::JunitSuite suite;
  bool passed = true;
};

/// The summary.json of a run; throws Refused.
[[nodiscard]] campaign::Json summary_json_of(const std::filesystem::path& run);

/// Prints the folder and a line for each limit: of the mission that the run has flown, or of `limits_file` if it is not
/// empty. Throws Refused if there is no limit.
[[nodiscard]] CheckedRun checked_run(const std::filesystem::path& folder, const std::filesystem::path& limits_file);

/// Judges the run by its own limits; returns an empty value if it has none.
void print_own_limits(const std::filesystem::path& run_folder);

}  // namespace vbar::app
