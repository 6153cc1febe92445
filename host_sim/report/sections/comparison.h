#pragma once
// Several runs side by side (SIL | PIL | HIL): the paper's performance metrics, and whether the outputs are the same
// bits.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "host_sim/report/published_figures.h"
#include "host_sim/report/run_record.h"

namespace vbar::report {

struct ComparedRun {
  std::string name;
  RunRecord record;
};

/// Returns whether both runs gave the same maneuver commands and the same telemetry, bit for bit.
[[nodiscard]] bool same_outputs(const Summary& a, const Summary& b);

/// Both runs are of the same mission with the same seed, so that their outputs should be the same on every flight
/// computer.
[[nodiscard]] bool expect_same_outputs(const Summary& a, const Summary& b);

/// Names of runs by the names of their folders, with as many parent folders as tell equal ones apart.
[[nodiscard]] std::vector<std::string> run_names(const std::vector<std::filesystem::path>& folders);

/// Published figures of the experiment that the runs repeat, if they do: further columns.
[[nodiscard]] std::vector<PaperColumn> paper_columns(std::span<const ComparedRun> runs);

/// The names of the runs, and of the paper's columns.
[[nodiscard]] std::vector<std::string> column_names(std::span<const ComparedRun> runs);

/// A line of the comparison: a cell for each column, or a heading without cells.
struct ComparisonRow {
  std::string name;
  std::vector<std::string> cells;
};

/// The first run is what the others are held against. Waypoints that a run did not reach are dashes.
[[nodiscard]] std::vector<ComparisonRow> comparison_rows(std::span<const ComparedRun> runs);

/// Returns the table for the console: aligned columns, a run each; ends in a line break.
[[nodiscard]] std::string comparison_table(std::span<const ComparedRun> runs);

}  // namespace vbar::report
