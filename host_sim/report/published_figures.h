#pragma once
// Published figures of a whole experiment, to stand beside runs of it in a comparison.

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/report/run_record.h"

namespace vbar::report {

struct PaperColumn {
  struct AtWaypoint {
    std::optional<double> control_error_m, navigation_error_m, navigation_velocity_error_mps;
  };

  std::string name;  ///< "paper, software in the loop"
  /// Returns the figures at a waypoint, empty for one that is not in the paper.
  std::function<AtWaypoint(const WaypointRow&)> at;
  std::optional<MeanAndDeviation> navigation_error_m, navigation_velocity_error_mps;
  double dv_mps = 0.0;
  int maneuvers = 0;
  std::optional<MeanAndDeviation> attitude_error_deg = {};  ///< attitude error of the target
};

// Tables of published figures  beside those of a run that meets the same waypoints.

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

namespace vbar::report::paper1 {

// Published figures of the paper's experiment 1 ("Performance metrics for Experiment #1"), software and hardware in the
// loop: to stand beside a run that meets the same waypoints.

struct Loop {
  double navigation_error_m = 0.0;
  double control_error_m = 0.0;
};

struct Loops {
  Loop software, hardware;
};

inline constexpr std::array<PaperWaypoint<Loops>, 7> kWaypoints{{
    {1, {-87.0, -50000.0, 0.0, 1000.0, 0.0, 1000.0}, {{80.04, 24.40}, {75.27, 113.88}}},
    {2, {-70.0, -25000.0, 0.0, 500.0, 0.0, 500.0}, {{50.75, 10.26}, {23.03, 73.59}}},
    {3, {-17.0, -5000.0, 0.0, 500.0, 0.0, 500.0}, {{3.18, 2.47}, {9.58, 13.17}}},
    {4, {0.0, -1000.0, 0.0, 30.0, 0.0, 30.0}, {{2.57, 3.91}, {6.70, 6.44}}},
    {5, {0.0, -600.0, 0.0, 18.0, 0.0, 18.0}, {{4.57, 8.01}, {10.12, 10.11}}},
    {6, {0.0, -200.0, 0.0, 6.0, 0.0, 6.0}, {{1.33, 3.64}, {1.09, 1.22}}},
    {7, {0.0, -100.0, 0.0, 3.0, 0.0, 3.0}, {{3.89, 8.77}, {3.06, 4.47}}},
}};

/// Figures of the whole experiment.
struct Totals {
  double dv_mps;
  int maneuvers;
};
inline constexpr Totals kSoftware{4.69, 61};
inline constexpr Totals kHardware{4.75, 90};

}  // namespace vbar::report::paper1

namespace vbar::report::paper2 {

// Published figures of the paper's experiment 2 (navigation by the pose network, waypoints 8 to 10), software and
// hardware in the loop: to stand beside a run that meets the same waypoints.

using paper1::Loop;
using paper1::Loops;

inline constexpr std::array<PaperWaypoint<Loops>, 2> kWaypoints{{
    {9, {0.0, -7.0, 1.0, 0.0, 2.0, 0.0}, {{0.0350, 0.2941}, {0.0572, 0.0898}}},
    {10, {0.0, -8.5, 1.0, 0.0, 1.0, 0.0}, {{0.0512, 0.1231}, {0.1035, 0.2450}}},
}};

/// Figures of the whole experiment.
struct Totals {
  MeanAndDeviation navigation_error_m, attitude_error_deg;
  double dv_mps;
  int maneuvers;
};
inline constexpr Totals kSoftware{{0.0457, 0.0143}, {3.1615, 2.3551}, 5.78e-3, 11};
inline constexpr Totals kHardware{{0.1250, 0.0956}, {4.1302, 2.1608}, 6.91e-3, 13};

}  // namespace vbar::report::paper2

namespace vbar::report::paper3 {

// Published figures of the paper's experiment 3, software and hardware in the loop ("Performance metrics for Experiment
// #3", and the text on delta-v): to stand beside a run that meets the same waypoints.

struct Figures {
  double navigation_error_m;
  double navigation_velocity_error_mps;
  double control_error_m;
};

struct Loops {
  Figures software, hardware;
};

inline constexpr std::array<PaperWaypoint<Loops>, 2> kWaypoints{
    {{9, {0.0, -7.0, 1.0, 0.0, 2.0, 0.0}, {{6.731e-3, 0.047e-3, 0.588}, {5.050e-3, 0.031e-3, 0.364}}},
     {10, {0.0, -8.5, 1.0, 0.0, 1.0, 0.0}, {{12.384e-3, 0.015e-3, 0.851}, {6.091e-3, 0.006e-3, 0.715}}}}};

/// Figures after the first fix; delta-v of the whole experiment.
struct Totals {
  MeanAndDeviation navigation_error_m, navigation_velocity_error_mps;
  double dv_mps;
  int maneuvers;
};
inline constexpr Totals kSoftware{{8.721e-3, 3.162e-3}, {0.024e-3, 0.011e-3}, 12.476e-3, 12};
inline constexpr Totals kHardware{{8.367e-3, 2.679e-3}, {0.021e-3, 0.009e-3}, 15.596e-3, 11};

}  // namespace vbar::report::paper3
