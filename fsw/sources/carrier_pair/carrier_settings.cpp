#include "fsw/sources/carrier_pair/carrier_settings.h"

#include "fsw/gnc/inbox.h"
#include "fsw/gnc/message_fields.h"
#include "fsw/math/math.h"
#include "fsw/sources/own_gnss/own_gnss_source.h"
#include "fsw/sources/valid_range.h"

namespace vbar::fsw::sources {

bool is_valid(const carrier_configuration& c) {
  const bool wander_is_usable = is_between(c.phase_wander_sigma_m, 0.0, 1.0) &&
                                is_between(c.phase_wander_time_s, 0.0, 1e6) &&
                                (c.phase_wander_sigma_m == 0.0 || c.phase_wander_time_s > 0.0);
  return is_positive(c.min_success_rate, 1.0) && is_between(c.min_ratio, 1.0, 1e6) &&
         gnc::is_usable(Duration{c.pair_wait_ns}) && gnc::vector(c.target_antenna_body_m).norm() < 100.0 &&
         is_positive(c.antenna_offset_sigma_m, 10.0) && is_positive(c.phase_centre_jitter_m, 1.0) && wander_is_usable &&
         is_positive(c.code_bias_sigma_m, 1e3) && is_positive(c.start_velocity_sigma, 1e3);
}

Result<CarrierSettings> carrier_settings(const carrier_configuration& c, const receiver_configuration& receiver) {
  if (!is_valid(c) || !is_valid(receiver)) return Status::kOutOfRange;
  CarrierSettings settings;
  settings.filter = {.antenna_offset_sigma_m = c.antenna_offset_sigma_m,
                     .phase_centre_jitter_m = c.phase_centre_jitter_m,
                     .code_bias_sigma_m = c.code_bias_sigma_m};
  settings.ambiguities.enabled = c.resolve_ambiguities != 0;
  settings.ambiguities.min_success_rate = c.min_success_rate;
  settings.ambiguities.min_ratio = c.min_ratio;
  settings.servicer_antenna_body_m = gnc::vector(receiver.antenna_body_m);
  settings.target_antenna_body_m = gnc::vector(c.target_antenna_body_m);
  settings.start_velocity_sigma = c.start_velocity_sigma;
  return settings;
}

estimation::GaussMarkov phase_wander_of(const carrier_configuration& c) {
  if (!(c.phase_wander_sigma_m > 0.0)) return {.sigma = 0.0, .time_s = 1.0};
  return {.sigma = math::sqrt(2.0) * c.phase_wander_sigma_m, .time_s = c.phase_wander_time_s};
}

}  // namespace vbar::fsw::sources
