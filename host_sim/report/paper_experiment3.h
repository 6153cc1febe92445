#pragma once
// What the paper says of its experiment 3, software in the loop ("Performance metrics for Experiment #3", and the text
// on delta-v): to stand beside a run that meets the same waypoints.

#include "host_sim/report/paper_table.h"

namespace vbar::report::paper3 {

struct Figures {
  double navigation_error_mm;
  double navigation_velocity_error_mmps;
  double control_error_m;
};

inline constexpr std::array<PaperWaypoint<Figures>, 2> kWaypoints{
    {{9, {0.0, -7.0, 1.0, 0.0, 2.0, 0.0}, {6.731, 0.047, 0.588}},
     {10, {0.0, -8.5, 1.0, 0.0, 1.0, 0.0}, {12.384, 0.015, 0.851}}}};

// Mean and standard deviation after the first fix; delta-v of the whole experiment.
inline constexpr const char* kNavigationError_mm = "8.721 ± 3.162";
inline constexpr const char* kNavigationVelocityError_mmps = "0.024 ± 0.011";
inline constexpr const char* kDeltaV_mmps = "12.476 in 12 maneuvers";

}  // namespace vbar::report::paper3
