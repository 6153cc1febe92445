#include "fsw/guidance/management.h"

#include <type_traits>

namespace vbar::fsw::guidance {
namespace {

/// Returns the parameters of the paper's mission; a telecommand replaces them.
gnc_configuration default_configuration() {
  gnc_configuration c{};
  c.compute_latency_ns = 1 * kNanosecondsPerSecond;
  c.closed_form_period_ns = 300 * kNanosecondsPerSecond;
  c.koenig_damico_period_ns = 60 * kNanosecondsPerSecond;
  c.koenig_damico_grid_ns = 30 * kNanosecondsPerSecond;
  c.planner_start_ns = 0;
  c.minimum_dv = 1e-6;
  c.maximum_dv = 10.0;
  c.roe_error_threshold_m = 0.0;
  c.keep_out_radius_m = 0.0;
  c.safety_horizon_s = 6000.0;
  c.station_keeping_deadband_m = 1.0;
  c.closed_form_tolerance_m = 0.3;
  c.koenig_damico_tolerance_m = 0.003;
  c.station_keeping_horizon_s = 18000.0;
  c.navigation_timeout_s = 600.0;
  return c;
}

static_assert(Management::kMaxWaypoints == std::extent_v<decltype(waypoint_table::waypoints)>);

}  // namespace

Management::Management() : configuration_(default_configuration()) {}

void Management::update(GpsTime now, const messaging::Telecommands& telecommands) {
  if (telecommands.is_new<gnc_configuration>()) configuration_ = *telecommands.in_force<gnc_configuration>();
  if (telecommands.is_new<thruster_configuration>()) thruster_ = *telecommands.in_force<thruster_configuration>();
  if (telecommands.is_new<safety_configuration>()) {
    safety_ = *telecommands.in_force<safety_configuration>();
    has_safety_ = true;
  }
  if (telecommands.is_new<waypoint_table>()) take(now, *telecommands.in_force<waypoint_table>());
  if (telecommands.is_new<mode_command>()) mode_ = static_cast<Mode>(telecommands.in_force<mode_command>()->mode);
  pass_waypoints(now);
  if (mode_ == Mode::kRetreat && !has_safety_) mode_ = Mode::kHold;  // the parameters of a retreat are unknown
  if (mode_ == Mode::kApproach && next_ == count_ && count_ > 0) mode_ = Mode::kStationKeeping;
}

/// Passes the waypoints whose time has come: the schedule is fixed in time, whatever the error on arrival.
void Management::pass_waypoints(GpsTime now) {
  while (next_ < count_ && waypoints_[next_].time <= now) ++next_;
}

/// Replaces the waypoint table. Station keeping ends with the table of its position, unless the new table has reached a
/// waypoint as well. A command to keep a position that has not been reached yet stays in force: table and command may
/// arrive in any order.
void Management::take(GpsTime now, const waypoint_table& table) {
  const bool was_keeping = mode() == Mode::kStationKeeping;
  reference_semi_major_axis_ = table.reference_semi_major_axis_m;
  count_ = static_cast<std::size_t>(table.count);  // validated by the store
  next_ = 0;
  for (std::size_t k = 0; k < count_; ++k) {
    const waypoint& w = table.waypoints[k];
    waypoints_[k].index = w.index;
    waypoints_[k].control_mode = w.control_mode;
    waypoints_[k].time = {w.gps_time_ns};
    waypoints_[k].keep_out_radius_m = w.keep_out_radius_m;
    for (int i = 0; i < 6; ++i) waypoints_[k].roe(i) = w.a_roe_m[i] / reference_semi_major_axis_;
  }
  pass_waypoints(now);
  if (was_keeping && next_ == 0) mode_ = Mode::kIdle;
}

}  // namespace vbar::fsw::guidance
