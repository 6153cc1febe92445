#pragma once
// Published figures of the paper's experiment 3, software and hardware in the loop ("Performance metrics for Experiment
// #3", and the text on delta-v): to stand beside a run that meets the same waypoints.

#include "host_sim/report/paper_table.h"

namespace vbar::report::paper3 {

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
