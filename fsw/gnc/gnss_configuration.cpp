#include "fsw/gnc/gnss_configuration.h"

#include "fsw/gnc/inbox.h"
#include "fsw/gnc/message_fields.h"
#include "fsw/math/math.h"

namespace vbar::fsw::gnc {
namespace {

orbit::EarthOrientation earth_orientation(const navigation_configuration& c) {
  return {.epoch = GpsTime{c.earth_epoch_ns},
          .ut1_minus_gps_s = c.ut1_minus_gps_s,
          .ut1_rate = c.ut1_rate,
          .pole_x = c.pole_x,
          .pole_y = c.pole_y};
}

}  // namespace

bool is_valid(const navigation_configuration& c) {
  const auto positive = [](double x, double maximum) { return x > 0.0 && x <= maximum; };
  const auto within = [](double x, double minimum, double maximum) { return x >= minimum && x <= maximum; };
  const bool wander_usable = within(c.phase_wander_sigma_m, 0.0, 1.0) && within(c.phase_wander_time_s, 0.0, 1e6) &&
                             (c.phase_wander_sigma_m == 0.0 || c.phase_wander_time_s > 0.0);
  return c.source >= 0 && c.source <= 3 && positive(c.min_success_rate, 1.0) && c.min_ratio >= 1.0 &&
         c.min_ratio <= 1e6 && is_usable(Duration{c.pair_wait_ns}) &&
         vector(c.servicer_antenna_body_m).norm() < 100.0 && vector(c.target_antenna_body_m).norm() < 100.0 &&
         positive(c.antenna_offset_sigma_m, 10.0) && positive(c.phase_centre_jitter_m, 1.0) && wander_usable &&
         positive(c.code_bias_sigma_m, 1e3) && positive(c.start_velocity_sigma, 1e3) &&
         positive(c.acceleration_sigma, 1.0) && positive(c.acceleration_time_s, 1e6) &&
         positive(c.maneuver_sigma, 1.0) && c.maneuver_sigma_relative >= 0.0 && c.maneuver_sigma_relative <= 1.0 &&
         is_usable(GpsTime{c.earth_epoch_ns}) && math::abs(c.ut1_minus_gps_s) < 100.0 && math::abs(c.ut1_rate) < 1e-6 &&
         math::abs(c.pole_x) < 1e-4 && math::abs(c.pole_y) < 1e-4;
}

Result<CarrierNavigationSettings> carrier_settings(const navigation_configuration& c) {
  if (!is_valid(c)) return Status::kOutOfRange;
  CarrierNavigationSettings settings;
  settings.pair_wait = Duration{c.pair_wait_ns};
  settings.carrier.filter = {.antenna_offset_sigma_m = c.antenna_offset_sigma_m,
                             .phase_centre_jitter_m = c.phase_centre_jitter_m,
                             .code_bias_sigma_m = c.code_bias_sigma_m};
  settings.carrier.ambiguities.enabled = c.resolve_ambiguities != 0;
  settings.carrier.ambiguities.min_success_rate = c.min_success_rate;
  settings.carrier.ambiguities.min_ratio = c.min_ratio;
  settings.carrier.servicer_antenna_body_m = vector(c.servicer_antenna_body_m);
  settings.carrier.target_antenna_body_m = vector(c.target_antenna_body_m);
  settings.carrier.start_velocity_sigma = c.start_velocity_sigma;
  settings.blocks.earth = earth_orientation(c);
  settings.blocks.burn_sigma = c.maneuver_sigma;
  settings.blocks.burn_sigma_relative = c.maneuver_sigma_relative;
  settings.blocks.relative_orbit.empirical = {.sigma = c.acceleration_sigma, .time_s = c.acceleration_time_s};
  if (c.phase_wander_sigma_m > 0.0) {
    // Of the difference of two independent channels.
    settings.blocks.phase_wander = {.sigma = math::sqrt(2.0) * c.phase_wander_sigma_m, .time_s = c.phase_wander_time_s};
  }
  return settings;
}

}  // namespace vbar::fsw::gnc
