#include "host_sim/mission/telecommands.h"

#include <algorithm>

namespace vbar::mission {

vbar::waypoint_table waypoint_table_of(const Mission& mission) {
  vbar::waypoint_table table{};
  table.reference_semi_major_axis_m = mission.guidance.reference_semi_major_axis_m;
  for (const Waypoint& waypoint : mission.waypoints) {
    vbar::waypoint& entry = table.waypoints[table.count++];
    entry.index = waypoint.index;
    entry.control_mode = static_cast<std::int8_t>(waypoint.solver);
    entry.gps_time_ns = waypoint.time.ns;
    std::copy(waypoint.a_roe_m.begin(), waypoint.a_roe_m.end(), entry.a_roe_m);
  }
  return table;
}

vbar::gnc_configuration gnc_configuration_of(const Mission& mission) {
  const Guidance& guidance = mission.guidance;
  vbar::gnc_configuration configuration{};
  configuration.compute_latency_ns = guidance.compute_latency.ns;
  configuration.closed_form_period_ns = guidance.closed_form_period.ns;
  configuration.koenig_damico_period_ns = guidance.koenig_damico_period.ns;
  configuration.koenig_damico_grid_ns = guidance.koenig_damico_grid.ns;
  configuration.planner_start_ns = guidance.planner_start.ns;
  configuration.minimum_dv = guidance.minimum_dv;
  configuration.maximum_dv = guidance.maximum_dv;
  configuration.roe_error_threshold_m = guidance.roe_error_threshold_m;
  configuration.keep_out_radius_m = guidance.keep_out_radius_m;
  configuration.safety_horizon_s = guidance.safety_horizon_s;
  configuration.station_keeping_deadband_m = guidance.station_keeping_deadband_m;
  configuration.closed_form_tolerance_m = guidance.closed_form_tolerance_m;
  configuration.koenig_damico_tolerance_m = guidance.koenig_damico_tolerance_m;
  configuration.station_keeping_horizon_s = guidance.station_keeping_horizon_s;
  configuration.navigation_timeout_s = guidance.navigation_timeout_s;
  return configuration;
}

vbar::mode_command mode_command_of(const Mission& mission) {
  vbar::mode_command command{};
  command.mode = static_cast<std::int8_t>(mission.guidance.mode);
  return command;
}

}  // namespace vbar::mission
