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
// are the initial values of the flight software (fsw/gnc/management.cpp).
void read_guidance(const TableReader& document, Mission& mission) {
  const TableReader section = document.table("guidance");
  constexpr Range kPeriod_s = from_to(1e-3, 1e6);
  Guidance& guidance = mission.guidance;
  guidance.mode = section.choice<Mode>("mode", kModes, mission.flies() ? Mode::kApproach : Mode::kIdle);
  if (guidance.mode == Mode::kApproach && mission.waypoints.empty())
    section.refuse("mode", "approach without a waypoint", "at least one [[waypoint]], or another mode");
  // PRISMA's mean semi-major axis, the mean of the paper's osculating elements by first-order Brouwer theory.
  guidance.reference_semi_major_axis_m =
      1e3 * section.number("reference_semi_major_axis_km", from_to(6400.0, 1e6), 7078.138944);

  vbar::gnc_configuration& c = guidance.configuration;
  const fsw::Duration latency = longest_compute_latency(mission);
  c.compute_latency_ns = section.span("compute_latency_s", 1.0, from_to(0.0, 3600.0), fsw::seconds(latency)).ns;
  c.closed_form_period_ns = section.span("closed_form_period_s", 1.0, kPeriod_s, 300.0).ns;
  c.koenig_damico_period_ns = section.span("koenig_damico_period_s", 1.0, kPeriod_s, 60.0).ns;
  c.koenig_damico_grid_ns = section.span("koenig_damico_grid_s", 1.0, kPeriod_s, 30.0).ns;
  c.planner_start_ns = (mission.start_time() + section.span("planner_delay_s", 1.0, from_to(0.0, 1e6), 0.0)).ns;
  c.minimum_dv = 1e-3 * section.number("dv_min_mmps", from_to(0.0, 1e3), 1e-3);
  c.maximum_dv = section.number("dv_max_mps", above_to(0.0, 1e3), 10.0);
  c.roe_error_threshold_m = section.number("roe_error_threshold_m", from_to(0.0, 1e6), 0.0);
  c.keep_out_radius_m = section.number("keep_out_radius_m", from_to(0.0, 1e5), 0.0);
  c.safety_horizon_s = section.number("safety_horizon_s", from_to(0.0, 2e5), 6000.0);
  c.station_keeping_deadband_m = section.number("station_keeping_deadband_m", above_to(0.0, 1e5), 1.0);
  c.closed_form_tolerance_m = section.number("closed_form_tolerance_m", above_to(0.0, 1e5), 0.3);
  c.koenig_damico_tolerance_m = section.number("koenig_damico_tolerance_m", above_to(0.0, 1e5), 0.003);
  c.station_keeping_horizon_s = section.number("station_keeping_horizon_s", above_to(0.0, 1e6), 18000.0);
  c.navigation_timeout_s = section.number("navigation_timeout_s", above_to(0.0, 1e6), 600.0);
  section.finish();
  if (c.compute_latency_ns < latency.ns)
    section.refuse_value("compute_latency_s",
                         "at least the flight computer's compute_latency_s, or its burns come too late");
  if (c.maximum_dv <= c.minimum_dv) section.refuse_value("dv_max_mps", "more than dv_min_mmps");
}

}  // namespace vbar::mission
