#include <algorithm>

#include "host_sim/mission/names.h"
#include "host_sim/mission/read_sections.h"

namespace vbar::mission {
namespace {

fsw::Duration longest_compute_latency(const Mission& mission) {
  fsw::Duration longest;
  for (const Spacecraft& spacecraft : mission.spacecraft)
    if (spacecraft.flight_computer) longest = std::max(longest, spacecraft.flight_computer->compute_latency);
  return longest;
}

}  // namespace

// Periods of the control loop are the paper's (its table of control solvers). Where the paper gives none, the defaults
// are those the flight software starts with (fsw/gnc/management.cpp).
void read_guidance(const TableReader& document, Mission& mission) {
  const TableReader section = document.table("guidance");
  section.accept_only({"mode", "reference_semi_major_axis_km", "compute_latency_s", "closed_form_period_s",
                       "koenig_damico_period_s", "koenig_damico_grid_s", "planner_delay_s", "minimum_dv_mmps",
                       "maximum_dv_mps", "roe_error_threshold_m", "keep_out_radius_m", "safety_horizon_s",
                       "station_keeping_deadband_m", "closed_form_tolerance_m", "koenig_damico_tolerance_m",
                       "station_keeping_horizon_s", "navigation_timeout_s"});
  constexpr Range kPeriod_s = from_to(1e-3, 1e6);
  Guidance& guidance = mission.guidance;
  guidance.mode = section.choice<Mode>("mode", kModes, mission.flies() ? Mode::kApproach : Mode::kIdle);
  if (guidance.mode == Mode::kApproach && mission.waypoints.empty())
    section.refuse("mode", "approach without a waypoint", "at least one [[waypoint]], or another mode");
  // PRISMA's mean semi-major axis, the mean of the paper's osculating elements by first-order Brouwer theory.
  guidance.reference_semi_major_axis_m =
      1e3 * section.number("reference_semi_major_axis_km", from_to(6400.0, 1e6), 7078.138944);

  const fsw::Duration latency = longest_compute_latency(mission);
  guidance.compute_latency = section.span("compute_latency_s", 1.0, from_to(0.0, 3600.0), fsw::seconds(latency));
  if (guidance.compute_latency < latency)
    section.refuse_value("compute_latency_s",
                         "at least the flight computer's compute_latency_s, or its burns come too late");
  guidance.closed_form_period = section.span("closed_form_period_s", 1.0, kPeriod_s, 300.0);
  guidance.koenig_damico_period = section.span("koenig_damico_period_s", 1.0, kPeriod_s, 60.0);
  guidance.koenig_damico_grid = section.span("koenig_damico_grid_s", 1.0, kPeriod_s, 30.0);
  guidance.planner_start = mission.start_time() + section.span("planner_delay_s", 1.0, from_to(0.0, 1e6), 0.0);

  guidance.minimum_dv = 1e-3 * section.number("minimum_dv_mmps", from_to(0.0, 1e3), 1e-3);
  guidance.maximum_dv = section.number("maximum_dv_mps", above_to(0.0, 1e3), 10.0);
  if (guidance.maximum_dv <= guidance.minimum_dv) section.refuse_value("maximum_dv_mps", "more than minimum_dv_mmps");
  guidance.roe_error_threshold_m = section.number("roe_error_threshold_m", from_to(0.0, 1e6), 0.0);
  guidance.keep_out_radius_m = section.number("keep_out_radius_m", from_to(0.0, 1e5), 0.0);
  guidance.safety_horizon_s = section.number("safety_horizon_s", from_to(0.0, 2e5), 6000.0);
  guidance.station_keeping_deadband_m = section.number("station_keeping_deadband_m", above_to(0.0, 1e5), 1.0);
  guidance.closed_form_tolerance_m = section.number("closed_form_tolerance_m", above_to(0.0, 1e5), 0.3);
  guidance.koenig_damico_tolerance_m = section.number("koenig_damico_tolerance_m", above_to(0.0, 1e5), 0.003);
  guidance.station_keeping_horizon_s = section.number("station_keeping_horizon_s", above_to(0.0, 1e6), 18000.0);
  guidance.navigation_timeout_s = section.number("navigation_timeout_s", above_to(0.0, 1e6), 600.0);
}

}  // namespace vbar::mission
