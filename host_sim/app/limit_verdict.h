#pragma once
// The limits of a mission against a run, printed one a line.

#include <filesystem>

#include <nlohmann/json.hpp>

#include "host_sim/campaign/summary_numbers.h"
#include "host_sim/check/junit_xml.h"

namespace vbar::app {

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
