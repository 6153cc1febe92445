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
    entry.keep_out_radius_m = waypoint.keep_out_radius_m.value_or(0.0);
  }
  return table;
}

vbar::mode_command mode_command_of(const Mission& mission) {
  vbar::mode_command command{};
  command.mode = static_cast<std::int8_t>(mission.guidance.mode);
  return command;
}

}  // namespace vbar::mission
