#pragma once
// Valid telecommands of navigation; a test changes what it is about.

#include <cstdint>

#include "fsw/packets/messages.h"
#include "tests/support/tango_view.h"
#include "tests/unit/fsw/gnc/small_world.h"

namespace vbar::fsw::gnc::test {

/// `sources`: sum of navigation_configuration::kUse.
inline navigation_configuration navigation(std::int32_t sources) {
  navigation_configuration c{};
  c.sources = sources;
  c.acceleration_psd = 1e-13;
  c.acceleration_psd_least = 1e-14;
  c.acceleration_psd_most = 1e-11;
  c.acceleration_sigma = 1e-8;
  c.acceleration_time_s = 1500.0;
  return c;
}

inline earth_configuration earth() {
  earth_configuration e{};
  e.epoch_ns = kEpoch.ns;
  e.ut1_minus_gps_s = -15.3;
  return e;
}

inline thruster_configuration thruster() {
  thruster_configuration t{};
  t.sigma_mps = 2e-6;
  t.sigma_relative = 2e-3;
  return t;
}

inline receiver_configuration receiver() {
  receiver_configuration r{};
  r.antenna_body_m[1] = -0.3;
  return r;
}

inline carrier_configuration carrier() {
  carrier_configuration c{};
  c.resolve_ambiguities = 1;
  c.min_success_rate = 0.999;
  c.min_ratio = 3.0;
  c.pair_wait_ns = 12 * kNanosecondsPerSecond;
  c.target_antenna_body_m[2] = 0.1;
  c.antenna_offset_sigma_m = 3.2e-3;
  c.phase_centre_jitter_m = 1e-3;
  c.phase_wander_sigma_m = 0.5e-3;
  c.phase_wander_time_s = 60.0;
  c.code_bias_sigma_m = 2.0;
  c.start_velocity_sigma = 0.2;
  return c;
}

inline camera_configuration camera() {
  camera_configuration c{};
  c.width = 800;
  c.height = 500;
  c.origin_x = 80;
  c.origin_y = 50;
  c.bits = 12;
  c.focal_length_px[0] = c.focal_length_px[1] = 1450.5;
  c.principal_point_px[0] = 479.5;
  c.principal_point_px[1] = 299.5;
  c.point_spread_sigma_px = 0.3;
  c.zero_magnitude_dn = 1e4;
  c.saturation_dn = 4000.0;
  c.gain_dn_per_electron = 0.03125;
  c.dark_level_dn = 64.0;
  c.noise_dn = 0.5;
  c.q_camera_body[0] = 1.0;
  return c;
}

inline angles_only_configuration angles_only() {
  angles_only_configuration a{};
  a.detection_sigmas = 5.0;
  a.centroid_floor_px = 0.05;
  a.pointing_tolerance = 0.01;
  a.brightness_offset_m = 0.15;
  a.centroid_noise_m = 0.05;
  a.bearing_bias = 1.5e-5;
  a.batch_images = 20;
  return a;
}

inline target_model target_shape() {
  target_model t{};
  const pose::KeypointShape shape = ::vbar::test::tango_shape();
  for (std::size_t k = 0; k < shape.size(); ++k) {
    for (int axis = 0; axis < 3; ++axis) t.keypoints_body_m[3 * k + static_cast<std::size_t>(axis)] = shape[k](axis);
  }
  t.inertia_kgm2[0] = 2.7;
  t.inertia_kgm2[1] = 2.5;
  t.inertia_kgm2[2] = 3.1;
  t.angular_acceleration_psd = 1e-11;
  return t;
}

inline safety_configuration safety() {
  safety_configuration c{};
  c.contact_distance_m = 2.0;
  c.horizon_s = 86400.0;
  c.retreat_delay_s = 600.0;
  c.semi_major_axis_error_m = 0.05;
  c.differential_drag = 1e-9;
  c.maximum_collision_probability = 1e-4;
  c.recession_m = 1.0;
  c.hold_distance_m = 200.0;
  c.hold_separation_m = 6.0;
  c.data_timeout_s = 2100.0;
  c.data_timeout_range_m = 100.0;
  c.target_size_m = 0.69;
  return c;
}

inline pose_configuration pose() {
  pose_configuration p{};
  p.keypoint_sigma_scale = 1.0;
  p.keypoint_floor_px = 0.2;
  for (double& sigma : p.start_sigma_a_roe_m) sigma = 5.0;
  p.start_images = 3;
  return p;
}

inline range_configuration ranges() {
  range_configuration r{};
  r.noise_sigma_m = 0.01;
  r.bias_sigma_m = 0.02;
  return r;
}

/// The target's present orbit, to a few hundred metres.
inline target_apriori target(const SmallWorld& world) {
  const ideal_navigation known = world.measurement();
  target_apriori apriori{};
  for (int k = 0; k < 3; ++k) {
    apriori.position_eci[k] = known.target_position_eci[k];
    apriori.velocity_eci[k] = known.target_velocity_eci[k];
  }
  for (double& sigma : apriori.sigma_a_roe_m) sigma = 300.0;
  return apriori;
}

/// Mean ROE of preceding navigation, m, to two metres.
inline target_apriori target(const Vector6& mean_a_roe_m) {
  target_apriori apriori{};
  apriori.kind = target_apriori::kKindRoe;
  for (int k = 0; k < 6; ++k) {
    apriori.mean_a_roe_m[k] = mean_a_roe_m(k);
    apriori.sigma_a_roe_m[k] = 2.0;
  }
  return apriori;
}

}  // namespace vbar::fsw::gnc::test
