#include "fsw/gnc/telecommand_checks.h"

#include <type_traits>

#include "fsw/control/solver_list.h"
#include "fsw/math/math.h"
#include "fsw/measurements/bearings/bearing_source.h"
#include "fsw/measurements/calibrated_camera.h"
#include "fsw/measurements/cdgnss/cdgnss_source.h"
#include "fsw/measurements/keypoints/keypoint_settings.h"
#include "fsw/measurements/source_list.h"
#include "fsw/messaging/inbox.h"
#include "fsw/messaging/message_fields.h"
#include "fsw/navigation/filter_configuration.h"

namespace vbar::fsw::gnc {
namespace {

constexpr double kLongestHorizon_s = 2e5;  // horizon of the assessment of a drift: forty revolutions
constexpr double kLargestARoe = 1e6;       // m; beyond it the relative-orbit models are not valid

bool is_usable_span(std::int64_t ns) {
  return messaging::is_usable(Duration{ns});
}
bool is_usable_span(double s) {
  return s > 0.0 && s <= seconds(messaging::kLongestSpan);
}

bool is_valid_waypoint(const waypoint& w) {
  if (!messaging::is_usable(GpsTime{w.gps_time_ns}) || !control::is_solver(w.control_mode)) return false;
  for (const double a_roe : w.a_roe_m) {
    if (math::abs(a_roe) > kLargestARoe) return false;
  }
  return w.keep_out_radius_m >= 0.0 && w.keep_out_radius_m <= kLargestARoe;
}

}  // namespace

bool is_valid(const waypoint_table& table) {
  constexpr auto kMaxWaypoints = static_cast<std::int32_t>(std::extent_v<decltype(waypoint_table::waypoints)>);
  if (table.count < 1 || table.count > kMaxWaypoints) return false;
  if (table.reference_semi_major_axis_m < 6.4e6 || table.reference_semi_major_axis_m > 1e9) return false;
  for (std::int32_t k = 0; k < table.count; ++k) {
    if (!is_valid_waypoint(table.waypoints[k])) return false;
    if (k > 0 && table.waypoints[k].gps_time_ns <= table.waypoints[k - 1].gps_time_ns) return false;
  }
  return true;
}

bool is_valid(const gnc_configuration& c) {
  return (c.compute_latency_ns == 0 || is_usable_span(c.compute_latency_ns)) &&
         is_usable_span(c.closed_form_period_ns) && is_usable_span(c.koenig_damico_period_ns) &&
         is_usable_span(c.koenig_damico_grid_ns) && c.minimum_dv >= 0.0 && c.maximum_dv > c.minimum_dv &&
         c.roe_error_threshold_m >= 0.0 && c.keep_out_radius_m >= 0.0 && c.safety_horizon_s >= 0.0 &&
         c.station_keeping_deadband_m > 0.0 && c.closed_form_tolerance_m > 0.0 && c.koenig_damico_tolerance_m > 0.0 &&
         is_usable_span(c.station_keeping_horizon_s) && c.navigation_timeout_s > 0.0;
}

bool is_valid(const mode_command& command) {
  return command.mode >= 0 && command.mode <= mode_command::kModeRetreat;
}

bool is_valid(const safety_configuration& c) {
  constexpr double kLargestDistance_m = 1e5;
  const auto is_distance = [](double x) { return x > 0.0 && x <= kLargestDistance_m; };
  return is_distance(c.contact_distance_m) && is_distance(c.recession_m) && is_distance(c.hold_distance_m) &&
         is_distance(c.hold_separation_m) && is_distance(c.data_timeout_range_m) && is_distance(c.target_size_m) &&
         is_usable_span(c.horizon_s) && c.horizon_s <= kLongestHorizon_s && is_usable_span(c.retreat_delay_s) &&
         is_usable_span(c.data_timeout_s) && c.semi_major_axis_error_m >= 0.0 &&
         c.semi_major_axis_error_m <= kLargestDistance_m && c.differential_drag >= 0.0 && c.differential_drag <= 1e-3 &&
         c.maximum_collision_probability > 0.0 && c.maximum_collision_probability <= 1.0 &&
         c.hold_distance_m > c.contact_distance_m && c.hold_separation_m > c.contact_distance_m;
}

bool is_valid(const fault_command& /*command*/) {
  return true;
}

using measurements::is_valid;
using navigation::is_valid;

namespace {

/// Tests whether an image feeds one measurement source: of a camera for bearings and keypoints the exposure decides
/// which, and there are two.
bool are_consistent(const messaging::Telecommands& telecommands) {
  constexpr std::int32_t kBoth = measurements::BearingSource::kUse | measurements::KeypointSource::kUse;
  const auto* navigation = telecommands.proposed_or_in_force<navigation_configuration>(0);
  if (navigation == nullptr || (navigation->sources & kBoth) != kBoth) return true;
  for (std::size_t unit = 0; unit < packets::kCameras; ++unit) {
    const auto* bearings = telecommands.proposed_or_in_force<angles_only_configuration>(unit);
    const auto* keypoints = telecommands.proposed_or_in_force<pose_configuration>(unit);
    const bool feeds_two = bearings != nullptr && keypoints != nullptr;
    if (feeds_two && !measurements::two_exposures(*bearings, *keypoints).ok()) return false;
  }
  return true;
}

template <class Message>
constexpr void set(messaging::TelecommandCheck<Message>& check) {
  check.is_valid = [](const Message& message) { return is_valid(message); };
}

constexpr messaging::TelecommandRules kRules = [] {
  messaging::TelecommandRules rules;
  std::apply([](auto&... checks) { (set(checks), ...); }, rules.checks);
  rules.are_consistent = &are_consistent;
  rules.rejected_first = {packets::MessageTraits<pose_configuration>::kApid,
                          packets::MessageTraits<angles_only_configuration>::kApid,
                          packets::MessageTraits<navigation_configuration>::kApid};
  return rules;
}();

}  // namespace

const messaging::TelecommandRules& telecommand_rules() {
  return kRules;
}

}  // namespace vbar::fsw::gnc
