#pragma once
// Published figures of the paper's experiment 1 ("Performance metrics for Experiment #1"), software and hardware in the
// loop: to stand beside a run that meets the same waypoints.

#include "host_sim/report/paper_table.h"

namespace vbar::report::paper1 {

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
