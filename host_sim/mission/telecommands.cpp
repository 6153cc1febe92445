#include "host_sim/mission/telecommands.h"

#include <algorithm>
#include <cmath>

#include "fsw/math/math.h"

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

vbar::navigation_configuration navigation_configuration_of(const Mission& mission, const Spacecraft& servicer,
                                                           const truth::EarthOrientationSeries& orientation) {
  const GnssNavigation& navigation = mission.gnss_navigation;
  const Spacecraft& target = *mission.find_spacecraft(servicer.gnss->partner);
  vbar::navigation_configuration configuration{};
  configuration.source = 1;
  configuration.resolve_ambiguities = navigation.resolve_ambiguities ? 1 : 0;
  configuration.min_success_rate = navigation.min_success_rate;
  configuration.min_ratio = navigation.min_ratio;
  configuration.pair_wait_ns = navigation.pair_wait.ns;
  const auto copy_antenna = [](const Spacecraft& spacecraft, double(&antenna_m)[3]) {
    const fsw::Vector3& nominal = spacecraft.gnss->receiver.body_frame.antenna_in_body_m;
    std::copy(nominal.begin(), nominal.end(), antenna_m);
  };
  copy_antenna(servicer, configuration.servicer_antenna_body_m);
  copy_antenna(target, configuration.target_antenna_body_m);
  configuration.antenna_offset_sigma_m = navigation.antenna_offset_sigma_m;
  configuration.phase_centre_jitter_m = navigation.phase_centre_jitter_m;
  configuration.code_bias_sigma_m = navigation.code_bias_sigma_m;
  configuration.start_velocity_sigma = navigation.start_velocity_sigma;
  configuration.acceleration_sigma = navigation.acceleration_sigma;
  configuration.acceleration_time_s = navigation.acceleration_time_s;
  configuration.maneuver_sigma = navigation.maneuver_sigma;
  configuration.maneuver_sigma_relative = navigation.maneuver_sigma_relative;
  // GPS time is 19 s behind TAI. A prediction is told to what the IERS bulletins print: 10 us and 10 uas.
  constexpr double kGpsMinusTai_s = -19.0;
  constexpr double kLookAhead_s = 3600.0;
  const truth::EarthOrientation now = orientation.at(mission.start_time());
  const truth::EarthOrientation later = orientation.at(mission.start_time(), kLookAhead_s);
  configuration.earth_epoch_ns = mission.start_time().ns;
  configuration.ut1_minus_gps_s = 1e-5 * std::round(1e5 * (now.ut1_minus_tai_s - kGpsMinusTai_s));
  configuration.ut1_rate = (later.ut1_minus_tai_s - now.ut1_minus_tai_s) / kLookAhead_s;
  constexpr double kTenMicroarcseconds = 1e-5 * fsw::math::kPi / 648000.0;
  configuration.pole_x = kTenMicroarcseconds * std::round(now.pole_x / kTenMicroarcseconds);
  configuration.pole_y = kTenMicroarcseconds * std::round(now.pole_y / kTenMicroarcseconds);
  return configuration;
}

vbar::mode_command mode_command_of(const Mission& mission) {
  vbar::mode_command command{};
  command.mode = static_cast<std::int8_t>(mission.guidance.mode);
  return command;
}

}  // namespace vbar::mission
