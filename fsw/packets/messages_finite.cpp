#include <bit>
#include <cstddef>
#include <cstdint>

#include "fsw/packets/message_traits.h"

namespace vbar::fsw::packets {
namespace {

/// By the bits: no compiler option for fast mathematics can make this always true.
bool finite(double value) {
  constexpr std::uint64_t kExponentMask = 0x7FF0'0000'0000'0000U;
  return (std::bit_cast<std::uint64_t>(value) & kExponentMask) != kExponentMask;
}

bool finite(float value) {
  return finite(static_cast<double>(value));
}

template <class Number, std::size_t kSize>
// NOLINTNEXTLINE(cppcoreguidelines-avoid-c-arrays): a field of a packet type
bool finite(const Number (&values)[kSize]) {
  for (const Number value : values) {
    if (!finite(value)) return false;
  }
  return true;
}

template <class... Fields>
bool finite_fields(const Fields&... fields) {
  return (finite(fields) && ...);
}

}  // namespace

bool all_finite(const tick& /*message*/) {
  return true;
}

bool all_finite(const ideal_navigation& m) {
  return finite_fields(m.servicer_position_eci, m.servicer_velocity_eci, m.target_position_eci, m.target_velocity_eci);
}

bool all_finite(const gnss_bytes& /*message*/) {
  return true;
}

bool all_finite(const crosslink_gnss_bytes& /*message*/) {
  return true;
}

bool all_finite(const attitude& m) {
  return finite_fields(m.q_eci_body, m.rate_body);
}

bool all_finite(const crosslink_attitude& m) {
  return finite_fields(m.q_eci_body, m.rate_body);
}

bool all_finite(const image_tile& /*message*/) {
  return true;
}

bool all_finite(const executed_maneuver& m) {
  return finite(m.dv_rtn);
}

bool all_finite(const waypoint_table& m) {
  for (const waypoint& w : m.waypoints) {
    if (!finite(w.a_roe_m)) return false;
  }
  return finite(m.reference_semi_major_axis_m);
}

bool all_finite(const gnc_configuration& m) {
  return finite_fields(m.minimum_dv, m.maximum_dv, m.roe_error_threshold_m, m.keep_out_radius_m, m.safety_horizon_s,
                       m.station_keeping_deadband_m, m.closed_form_tolerance_m, m.koenig_damico_tolerance_m,
                       m.station_keeping_horizon_s, m.navigation_timeout_s);
}

bool all_finite(const mode_command& /*message*/) {
  return true;
}

bool all_finite(const navigation_configuration& m) {
  return finite_fields(m.min_success_rate, m.min_ratio, m.servicer_antenna_body_m, m.target_antenna_body_m,
                       m.antenna_offset_sigma_m, m.phase_centre_jitter_m, m.code_bias_sigma_m, m.start_velocity_sigma,
                       m.acceleration_sigma, m.acceleration_time_s, m.maneuver_sigma, m.maneuver_sigma_relative,
                       m.ut1_minus_gps_s, m.ut1_rate, m.pole_x, m.pole_y);
}

bool all_finite(const camera_configuration& m) {
  return finite_fields(m.focal_length_px, m.principal_point_px, m.distortion, m.point_spread_sigma_px,
                       m.zero_magnitude_dn, m.saturation_dn, m.gain_dn_per_electron, m.q_camera_body,
                       m.position_body_m);
}

bool all_finite(const angles_only_configuration& m) {
  return finite_fields(m.detection_sigmas, m.centroid_floor_px, m.pointing_tolerance, m.acceleration_psd,
                       m.acceleration_psd_least, m.acceleration_psd_most, m.brightness_offset_m, m.maneuver_sigma,
                       m.maneuver_sigma_relative);
}

bool all_finite(const target_apriori& m) {
  return finite_fields(m.position_eci, m.velocity_eci, m.sigma_a_roe_m);
}

bool all_finite(const pose_configuration& m) {
  return finite_fields(m.dark_level_dn, m.noise_dn, m.keypoints_body_m, m.inertia_kgm2, m.keypoint_sigma_scale,
                       m.keypoint_floor_px, m.acceleration_psd, m.acceleration_psd_least, m.acceleration_psd_most,
                       m.angular_acceleration_psd, m.maneuver_sigma, m.maneuver_sigma_relative, m.apriori_a_roe_m,
                       m.apriori_sigma_a_roe_m, m.start_sigma_a_roe_m);
}

bool all_finite(const maneuver_command& m) {
  return finite(m.dv_rtn);
}

bool all_finite(const pointing_command& m) {
  return finite_fields(m.boresight_rtn, m.boresight_rate_rtn);
}

bool all_finite(const telemetry_navigation& m) {
  return finite_fields(m.age_s, m.servicer_position_eci, m.servicer_velocity_eci, m.relative_position_rtn,
                       m.relative_velocity_rtn, m.sigma_rtn, m.a_roe_mean_m);
}

bool all_finite(const telemetry_control& m) {
  return finite_fields(m.a_roe_desired_m, m.predicted_a_roe_error_m, m.planned_dv, m.passive_safety_distance_m,
                       m.commanded_dv);
}

bool all_finite(const telemetry_health& /*message*/) {
  return true;
}

bool all_finite(const telemetry_gnss& m) {
  return finite_fields(m.success_rate, m.ratio, m.code_nis, m.phase_nis, m.covariance_rtn);
}

bool all_finite(const telemetry_image& m) {
  return finite_fields(m.background_dn, m.noise_dn, m.q_eci_camera, m.attitude_sigma, m.bearing_eci, m.bearing_sigma,
                       m.prefit, m.postfit, m.nis, m.covariance_a_roe, m.a_roe_osculating_m);
}

bool all_finite(const telemetry_objects& m) {
  return finite_fields(m.x_px, m.y_px);
}

bool all_finite(const telemetry_pose& m) {
  return finite_fields(m.region_px, m.x_px, m.y_px, m.covariance_px2, m.peak, m.pnp_q_camera_body,
                       m.pnp_position_camera_m, m.pnp_mean_square, m.q_camera_body, m.position_camera_m, m.rate_body,
                       m.covariance_attitude, m.covariance_a_roe, m.a_roe_osculating_m, m.nis, m.acceleration_psd);
}

bool all_finite(const step_report& /*message*/) {
  return true;
}

}  // namespace vbar::fsw::packets
