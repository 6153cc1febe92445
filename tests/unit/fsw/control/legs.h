#pragma once
// The far legs of the paper's waypoint table as planning problems, with the numbers of independent solutions.

#include <array>

#include "fsw/control/plan.h"
#include "fsw/orbit/propagate.h"
#include "tests/unit/fsw/orbit/mission.h"

namespace vbar::fsw::control::legs {

namespace mission = orbit::mission;

/// Pseudo-states by the linear J2 transition of exact waypoints; bounds, in-plane optima and totals (m/s, rounded in
/// the last digit) by an independent implementation in Python (closed form; linear program on a dense grid of times;
/// cone program for the total).
struct Leg {
  std::size_t from;  ///< waypoint
  std::array<double, 6> a_pseudo_state_m;
  double bound_da, bound_de, bound_dlambda;
  double normal_burn;    ///< coupling by J2 included
  double three_burns;    ///< in plane, on the phase grid
  double dense_optimum;  ///< in plane, any times
  double fuel_optimal;   ///< all burns, steerable thruster, fine grid; within 1 %
};

inline constexpr std::array<Leg, 7> kFarLegs{{
    {0, {1913, -43502.823, 0, 1000.099, 0, 970.211}, 1.0141, .5301, .3325, 1.0487, 1.0141, 1.0141, 1.460},
    {1, {17, 22020.127, -13.568, -499.904, 0, -501.296}, .0090, .2651, .6906, .5416, .8825, .8439, 1.025},
    {2, {53, 17602.401, -6.784, .050, 0, -1.043}, .0281, .0036, .5730, .0092, .7016, .6628, .662},
    {3, {17, 3417.725, -6.784, -469.953, 0, -470.253}, .0090, .2491, .1148, .5001, .2491, .2492, .561},
    {4, {0, 400, -.271, -11.999, 0, -12}, 0, .0064, .0186, .0129, .0241, .0224, .0271},
    {5, {0, 400, -.163, -11.999, 0, -12}, 0, .0064, .0186, .0129, .0241, .0226, .0271},
    {6, {0, 100, -.054, -3, 0, -3}, 0, .0016, .0046, .0032, .0060, .0053, .0065},
}};

/// The servicer's mean orbit at the leg's start, unburned; epoch zero at the leg's start.
inline ControlProblem problem(const Leg& leg) {
  const double start = mission::kWaypoints[leg.from].time_h * 3600.0;
  const double arrival = mission::kWaypoints[leg.from + 1].time_h * 3600.0;
  return {.start = {},
          .arrival = GpsTime{} + nearest_duration(arrival - start),
          .servicer_mean = orbit::propagate_secular(mission::kServicerMean, start),
          .pseudo_state = Vector6(leg.a_pseudo_state_m.data()) / mission::kReferenceA};
}

}  // namespace vbar::fsw::control::legs
