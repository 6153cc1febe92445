#pragma once
// What the paper says of its experiment 2 (navigation by the pose network, waypoints 8 to 10), software and hardware in
// the loop: to stand beside a run that meets the same waypoints.

#include <array>

#include "host_sim/report/run_record.h"

namespace vbar::report::paper2 {

struct Loop {
  double navigation_error_m = 0.0;
  double control_error_m = 0.0;
};

struct Waypoint {
  int index;
  Sextuple a_roe_m;  ///< of its table of waypoints
  Loop software, hardware;
};

inline constexpr std::array<Waypoint, 2> kWaypoints{{
    {9, {0.0, -7.0, 1.0, 0.0, 2.0, 0.0}, {0.0350, 0.2941}, {0.0572, 0.0898}},
    {10, {0.0, -8.5, 1.0, 0.0, 1.0, 0.0}, {0.0512, 0.1231}, {0.1035, 0.2450}},
}};

/// Of the whole experiment.
struct Totals {
  MeanAndDeviation navigation_error_m, attitude_error_deg;
  double dv_mps;
  int maneuvers;
};
inline constexpr Totals kSoftware{{0.0457, 0.0143}, {3.1615, 2.3551}, 5.78e-3, 11};
inline constexpr Totals kHardware{{0.1250, 0.0956}, {4.1302, 2.1608}, 6.91e-3, 13};

/// The paper's row of the waypoint that `row` is; null if it is none of the paper's.
[[nodiscard]] inline const Waypoint* waypoint(const WaypointRow& row) {
  for (const Waypoint& candidate : kWaypoints) {
    if (candidate.index == row.index && candidate.a_roe_m == row.a_roe_desired_m) return &candidate;
  }
  return nullptr;
}

}  // namespace vbar::report::paper2
