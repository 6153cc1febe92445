#include "host_sim/twins/gnss/gnss_settings.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace vbar::twins::gnss {
namespace {

void need_between(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high))
    throw std::invalid_argument(fmt::format("{} = {}: accepted is {} to {}", name, value, low, high));
}

// An interval of times from 0 to a day.
void need_interval(const char* min_name, double min_s, const char* max_name, double max_s) {
  need_between(min_name, min_s, 0.0, 86400.0);
  need_between(max_name, max_s, 0.0, 86400.0);
  if (min_s > max_s)
    throw std::invalid_argument(fmt::format("{} = {} is above {} = {}", min_name, min_s, max_name, max_s));
}

void check_visibility(const VisibilitySettings& visibility) {
  need_between("transmit_aperture_deg", visibility.transmit_aperture_deg, 1.0, 360.0);
  need_between("receiver_mask_deg", visibility.receiver_mask_deg, 1.0, 360.0);
  need_between("horizon_mask_deg", visibility.horizon_mask_deg, -90.0, 89.0);
  need_between("occultation_altitude_km", visibility.occultation_altitude_km, 0.0, 1000.0);
}

void check_link_budget(const LinkBudgetSettings& link) {
  need_between("boresight_gain_dbi", link.boresight_gain_dbi, -30.0, 30.0);
  need_between("antenna_temperature_k", link.antenna_temperature_k, 1.0, 10000.0);
  need_between("lna_gain_db", link.lna_gain_db, 0.0, 80.0);
  need_between("lna_noise_figure_db", link.lna_noise_figure_db, 0.01, 30.0);
  need_between("receiver_noise_figure_db", link.receiver_noise_figure_db, 0.01, 60.0);
  need_between("losses_db", link.losses_db, 0.0, 60.0);
}

void check_tracking(const TrackingSettings& tracking) {
  need_between("code_loop_bandwidth_hz", tracking.code_loop_bandwidth_hz, 1e-3, 100.0);
  need_between("carrier_loop_bandwidth_hz", tracking.carrier_loop_bandwidth_hz, 0.1, 100.0);
  need_between("integration_s", tracking.integration_s, 1e-3, 1.0);
  need_between("acquisition_threshold_dbhz", tracking.acquisition_threshold_dbhz, 0.0, 70.0);
  need_between("loss_threshold_dbhz", tracking.loss_threshold_dbhz, 0.0, 70.0);
  if (tracking.loss_threshold_dbhz > tracking.acquisition_threshold_dbhz)
    throw std::invalid_argument(fmt::format("loss_threshold_dbhz = {} is above acquisition_threshold_dbhz = {}",
                                            tracking.loss_threshold_dbhz, tracking.acquisition_threshold_dbhz));
  need_between("cycle_slips_per_hour", tracking.cycle_slips_per_hour, 0.0, 3600.0);
  need_between("undetected_slip_fraction", tracking.undetected_slip_fraction, 0.0, 1.0);
  need_between("code_bias_sigma_m", tracking.code_bias_sigma_m, 0.0, 1000.0);
  need_between("carrier_wander_sigma_mm", tracking.carrier_wander_sigma_mm, 0.0, 100.0);
  need_between("carrier_wander_time_s", tracking.carrier_wander_time_s, 1e-3, 1e6);
  need_between("w_code_rate_khz", tracking.w_code_rate_khz, 0.0, 10230.0);
  need_between("code_wander_l1_zenith_m", tracking.code_wander_l1.zenith_m, 0.0, 100.0);
  need_between("code_wander_l1_horizon_m", tracking.code_wander_l1.horizon_m, 0.0, 100.0);
  need_between("code_wander_l2_zenith_m", tracking.code_wander_l2.zenith_m, 0.0, 100.0);
  need_between("code_wander_l2_horizon_m", tracking.code_wander_l2.horizon_m, 0.0, 100.0);
  need_between("code_wander_time_s", tracking.code_wander_time_s, 1e-3, 1e6);
}

void check_start(const StartSettings& start) {
  need_interval("cold_search_min_s", start.cold_search_min_s, "cold_search_max_s", start.cold_search_max_s);
  need_interval("reacquisition_min_s", start.reacquisition_min_s, "reacquisition_max_s", start.reacquisition_max_s);
  need_between("ephemeris_decoding_s", start.ephemeris_decoding_s, 0.0, 3600.0);
}

void check_clock(const ClockSettings& clock) {
  need_between("initial_offset_ms", clock.initial_offset_ms, 0.0, 50.0);
  need_between("initial_drift_sigma_ns_per_s", clock.initial_drift_sigma_ns_per_s, 0.0, 1e4);
  need_between("h0_s", clock.h0_s, 0.0, 1e-15);
  need_between("h_minus2_per_s", clock.h_minus2_per_s, 0.0, 1e-15);
  need_between("jump_threshold_ms", clock.jump_threshold_ms, 0.5, 100.0);
}

void check_body_frame(const BodyFrameSettings& body) {
  for (const double component : body.antenna_in_body_m) need_between("antenna_in_body_m", component, -100.0, 100.0);
  if (!(std::abs(body.boresight_in_body.norm() - 1.0) < 1e-6))
    throw std::invalid_argument(
        fmt::format("boresight_in_body has length {}: accepted is a unit vector", body.boresight_in_body.norm()));
  need_between("com_radius_mm", body.com_radius_mm, 0.0, 1e4);
  need_between("pco_bias_mm", body.pco_bias_mm, 0.0, 1e4);
  need_between("pco_noise_mm", body.pco_noise_mm, 0.0, 1e4);
  need_between("antenna_direction_arcsec", body.antenna_direction_arcsec, 0.0, 36000.0);
  need_between("attitude_knowledge_arcsec", body.attitude_knowledge_arcsec, 0.0, 36000.0);
}

void check_output(const OutputSettings& output) {
  need_between("period_s", output.period_s, 0.1, 60.0);
  if (std::abs(output.period_s * 1000.0 - std::round(output.period_s * 1000.0)) > 1e-9)
    throw std::invalid_argument(
        fmt::format("period_s = {}: accepted is an integer number of milliseconds", output.period_s));
  need_between("ephemeris_period_s", output.ephemeris_period_s, 1.0, 1e5);
  need_between("corrections_period_s", output.corrections_period_s, 1.0, 1e5);
}

}  // namespace

double CodeWander::sigma_m(double sin_elevation) const {
  const double cos2 = 1.0 - sin_elevation * sin_elevation;
  return std::sqrt(zenith_m * zenith_m * sin_elevation * sin_elevation + horizon_m * horizon_m * std::max(0.0, cos2));
}

void check(const GnssReceiverSettings& settings) {
  check_visibility(settings.visibility);
  check_link_budget(settings.link_budget);
  check_tracking(settings.tracking);
  check_start(settings.start);
  check_clock(settings.clock);
  check_body_frame(settings.body_frame);
  check_output(settings.output);
}

}  // namespace vbar::twins::gnss
