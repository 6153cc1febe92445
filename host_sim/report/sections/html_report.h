#pragma once
// The waypoint table of a run for the console: how each waypoint was met and what it cost.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "host_sim/report/run_record.h"
#include "host_sim/report/sections/comparison.h"

namespace vbar::report {

/// Aligned columns, units in the head, a line a waypoint and one for the whole run. Ends in a line break.
[[nodiscard]] std::string waypoint_table(const RunRecord& record);

// report.html: a run as an engineer judges it, in one file that opens from disk.

/// `note`: HTML of a line below the overview; empty: none.
[[nodiscard]] std::string html_report(const RunRecord& record, std::string_view note = {});

/// Writes report.html into the run's folder and returns where. Throws std::runtime_error that names the file.
std::filesystem::path write_html_report(const std::filesystem::path& run_folder, const RunRecord& record,
                                        std::string_view note = {});

// A page with several runs side by side (html_comparison.cpp): the comparison's table, and distances, errors, paths,
// delta-v and ROE of all runs in the same plots.

/// Returns the page of at least one run.
[[nodiscard]] std::string html_comparison(std::span<const ComparedRun> runs);

/// Throws std::runtime_error that names the file.
void write_html_comparison(const std::filesystem::path& file, std::span<const ComparedRun> runs);

}  // namespace vbar::report
