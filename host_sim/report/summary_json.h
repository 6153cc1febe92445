#pragma once
// summary.json: what scripts and CI read of a run. SI units stand in the names; null where a value does not apply.

#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/report/run_record.h"

namespace vbar::report {

/// The text of summary.json.
[[nodiscard]] std::string summary_json(const Summary& summary, const std::vector<WaypointRow>& waypoints);

/// Reads all but the waypoints, which waypoints.csv holds in full. Throws std::runtime_error that names the file and
/// what is wrong with it.
[[nodiscard]] Summary read_summary(const std::filesystem::path& file);

/// Returns whether the file is a summary that a run left, of this version of the program or another.
[[nodiscard]] bool is_summary(const std::filesystem::path& file);

}  // namespace vbar::report
