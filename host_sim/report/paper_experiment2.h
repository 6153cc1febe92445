#pragma once
// Published figures of the paper's experiment 2 (navigation by the pose network, waypoints 8 to 10), software and
// hardware in the loop: to stand beside a run that meets the same waypoints.

#include "host_sim/report/paper_experiment1.h"
#include "host_sim/report/paper_table.h"

namespace vbar::report::paper2 {

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
