#pragma once
// Tables of published figures (paper_experiment1.h to 3) beside those of a run that meets the same waypoints.

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/report/run_record.h"

namespace vbar::report {

/// A row of the paper's table of waypoints, with the figures that an experiment publishes for each.
template <class Figures>
struct PaperWaypoint {
  int index;
  Sextuple a_roe_m;
  Figures figures;
};

/// The paper's figures at the waypoint that `row` is; null if the waypoint is not in the paper.
template <class Figures, std::size_t size>
[[nodiscard]] const Figures* at_waypoint(const std::array<PaperWaypoint<Figures>, size>& paper,
                                         const WaypointRow& row) {
  for (const PaperWaypoint<Figures>& candidate : paper) {
    if (candidate.index == row.index && candidate.a_roe_m == row.a_roe_desired_m) return &candidate.figures;
  }
  return nullptr;
}

/// The run meets at least one waypoint of the paper.
template <class Figures, std::size_t size>
[[nodiscard]] bool meets_paper(const std::array<PaperWaypoint<Figures>, size>& paper,
                               const std::vector<WaypointRow>& rows) {
  for (const WaypointRow& row : rows)
    if (at_waypoint(paper, row) != nullptr) return true;
  return false;
}

/// Mean and standard deviation, a dash for none.
[[nodiscard]] std::string plus_minus(const std::optional<MeanAndDeviation>& value, int decimals, double scale = 1.0);

/// Names of the rows of such a table.
inline constexpr const char* kThisRun = "this run";
inline constexpr const char* kPaperSoftware = "paper, software in the loop";
inline constexpr const char* kPaperHardware = "paper, hardware in the loop";

}  // namespace vbar::report
