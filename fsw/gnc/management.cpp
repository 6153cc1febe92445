#include "fsw/gnc/management.h"

#include "fsw/math/math.h"

namespace vbar::fsw::gnc {
namespace {

constexpr double kLargestARoe = 1e6;  // m; beyond it the relative-orbit models are not valid

/// Defaults are those of the paper's mission; a telecommand replaces them.
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

bool is_usable_span(std::int64_t ns) {
  return is_usable(Duration{ns});
}
bool is_usable_span(double s) {
  return s > 0.0 && s <= seconds(kLongestSpan);
}

}  // namespace

Management::Management() : configuration_(default_configuration()) {}

void Management::update(GpsTime now, Inbox& inbox) {
  const auto take_all = [&](const auto& queue) {
    for (std::size_t k = 0; k < queue.size(); ++k) {
      if (queue[k].tag.time > now) {
        inbox.count_unusable_time();
      } else if (!take(queue[k].value)) {
        inbox.count_bad_content();
      }
    }
  };
  take_all(inbox.queue<vbar::gnc_configuration>());
  take_all(inbox.queue<vbar::waypoint_table>());
  take_all(inbox.queue<vbar::mode_command>());

  // A waypoint is reached when its time comes: the schedule is fixed in time, whatever the error on arrival.
  while (next_ < count_ && waypoints_[next_].time <= now) ++next_;
  if (mode_ == Mode::kApproach && next_ == count_ && count_ > 0) mode_ = Mode::kStationKeeping;
  if (mode_ == Mode::kStationKeeping && next_ == 0) mode_ = Mode::kIdle;  // no waypoint reached: no position to keep
}

bool Management::take(const waypoint_table& table) {
  if (table.count < 1 || table.count > static_cast<std::int32_t>(kMaxWaypoints)) return false;
  if (table.reference_semi_major_axis_m < 6.4e6 || table.reference_semi_major_axis_m > 1e9) return false;
  const auto count = static_cast<std::size_t>(table.count);
  for (std::size_t k = 0; k < count; ++k) {
    const waypoint& w = table.waypoints[k];
    if (!is_usable(GpsTime{w.gps_time_ns})) return false;
    if (w.control_mode < 0 || w.control_mode > 2) return false;
    if (k > 0 && w.gps_time_ns <= table.waypoints[k - 1].gps_time_ns) return false;
    for (const double a_roe : w.a_roe_m) {
      if (math::abs(a_roe) > kLargestARoe) return false;
    }
  }
  reference_semi_major_axis_ = table.reference_semi_major_axis_m;
  count_ = count;
  next_ = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const waypoint& w = table.waypoints[k];
    waypoints_[k].index = w.index;
    waypoints_[k].control_mode = w.control_mode;
    waypoints_[k].time = {w.gps_time_ns};
    for (int i = 0; i < 6; ++i) waypoints_[k].roe(i) = w.a_roe_m[i] / reference_semi_major_axis_;
  }
  return true;
}

bool Management::take(const gnc_configuration& c) {
  const bool usable =
      (c.compute_latency_ns == 0 || is_usable_span(c.compute_latency_ns)) && is_usable_span(c.closed_form_period_ns) &&
      is_usable_span(c.koenig_damico_period_ns) && is_usable_span(c.koenig_damico_grid_ns) && c.minimum_dv >= 0.0 &&
      c.maximum_dv > c.minimum_dv && c.roe_error_threshold_m >= 0.0 && c.keep_out_radius_m >= 0.0 &&
      c.safety_horizon_s >= 0.0 && c.station_keeping_deadband_m > 0.0 && c.closed_form_tolerance_m > 0.0 &&
      c.koenig_damico_tolerance_m > 0.0 && is_usable_span(c.station_keeping_horizon_s) && c.navigation_timeout_s > 0.0;
  if (usable) configuration_ = c;
  return usable;
}

bool Management::take(const mode_command& command) {
  if (command.mode < 0 || command.mode > 3) return false;
  mode_ = static_cast<Mode>(command.mode);
  return true;
}

}  // namespace vbar::fsw::gnc
