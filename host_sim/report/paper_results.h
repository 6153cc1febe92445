#pragma once
// Results of the paper (published_figures.h) by table or figure and cell, as requirements and pages name them:
// "table_8.sil.waypoint_1.navigation_error_m"; sil, software in the loop; hil, hardware in the loop.

#include <map>
#include <optional>
#include <string>

namespace vbar::report {

/// Returns all cells. Table 8 and figure 8 are of experiment 1, table 9 and figure 13 of experiment 2, table 10 and
/// figure 16 of experiment 3; names end in the unit.
[[nodiscard]] const std::map<std::string, double>& paper_cells();

/// Returns the value of a cell; empty for an unknown name.
[[nodiscard]] std::optional<double> find_paper_cell(const std::string& name);

}  // namespace vbar::report
