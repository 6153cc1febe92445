#pragma once
// The control loop with ideal navigation, and nothing else of the flight software: true states in, the leg policy and
// its solvers, burns flown exactly.

#include <vector>

#include "fsw/core/types.h"

namespace vbar::testing {

/// What one decision period and burn command cost in time, and how well legs must arrive.
struct LoopSettings {
  int gravity_degree = 20;  ///< of the truth; the order is the same
  std::size_t first = 0;    ///< waypoint at which the run starts, exactly on its ROE ...
  std::size_t last = 7;
  fsw::Vector6 start_error_m = fsw::Vector6::Zero();  ///< ... but for this
  double start_delay_s = 0.0;                         ///< truth starts so much later along its orbit: other burn phases
  fsw::Vector6 navigation_sigma_m = fsw::Vector6::Zero();  ///< white error of the ROE estimate, also told to the policy
  unsigned seed = 1;
  double latency_s = 10.0;
  double tick_s = 60.0;
  int ticks_a_closed_form_decision = 5;  ///< 300 s, as in the paper
  double far_tolerance_m = 0.5;          ///< waypoints 1 to 3
  double middle_tolerance_m = 0.1;       ///< waypoints 4 to 7
  double close_tolerance_m = 0.002;      ///< waypoints 8 to 10
};

struct LegResult {
  std::size_t waypoint;
  double control_error_m;
  double dv_mps;
  int burns;
  int corrections;
  int replans;
  int hand_overs;  ///< plans by the fuel-optimal solver
};

/// Flies from waypoint `first` to `last`. Throws std::runtime_error if a conversion or a decision fails.
std::vector<LegResult> fly_mission(const LoopSettings& settings);

}  // namespace vbar::testing
