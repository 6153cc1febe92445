#include "fsw/measurements/cdgnss/cdgnss_source.h"

#include "fsw/math/math.h"
#include "fsw/measurements/gnss_absolute_source.h"
#include "fsw/messaging/inbox.h"
#include "fsw/messaging/message_fields.h"

namespace vbar::fsw::measurements {

bool is_valid(const carrier_configuration& c) {
  const bool wander_is_usable = messaging::is_between(c.phase_wander_sigma_m, 0.0, 1.0) &&
                                messaging::is_between(c.phase_wander_time_s, 0.0, 1e6) &&
                                (c.phase_wander_sigma_m == 0.0 || c.phase_wander_time_s > 0.0);
  return messaging::is_positive(c.min_success_rate, 1.0) && messaging::is_between(c.min_ratio, 1.0, 1e6) &&
         messaging::is_usable(Duration{c.pair_wait_ns}) && messaging::vector(c.target_antenna_body_m).norm() < 100.0 &&
         messaging::is_positive(c.antenna_offset_sigma_m, 10.0) &&
         messaging::is_positive(c.phase_centre_jitter_m, 1.0) && wander_is_usable &&
         messaging::is_positive(c.code_bias_sigma_m, 1e3) && messaging::is_positive(c.start_velocity_sigma, 1e3);
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
  settings.servicer_antenna_body_m = messaging::vector(receiver.antenna_body_m);
  settings.target_antenna_body_m = messaging::vector(c.target_antenna_body_m);
  settings.start_velocity_sigma = c.start_velocity_sigma;
  return settings;
}

estimation::GaussMarkov phase_wander_of(const carrier_configuration& c) {
  if (!(c.phase_wander_sigma_m > 0.0)) return {.sigma = 0.0, .time_s = 1.0};
  return {.sigma = math::sqrt(2.0) * c.phase_wander_sigma_m, .time_s = c.phase_wander_time_s};
}

static_assert(static_cast<int>(gnss::RejectionReason::kSearch) == telemetry_gnss::kObstacleSearch);

bool CdgnssSource::configure(const Configuration& configuration) {
  const auto* carrier = configuration.telecommands.in_force<carrier_configuration>();
  const auto* receiver = configuration.telecommands.in_force<receiver_configuration>();
  if (carrier == nullptr || receiver == nullptr) return false;
  const auto settings = carrier_settings(*carrier, *receiver);
  if (!settings.ok()) return false;
  configuration.settings.processes.of<PhaseWander>() = phase_wander_of(*carrier);
  aiding_.configure(settings.value());
  pair_wait_ = Duration{carrier->pair_wait_ns};
  return true;
}

void CdgnssSource::collect(Context& context, RecordFiler records) {
  owed_.reset();
  const gnss::EpochBuffer& ours = context.gnss.waiting(gnss::Receiver::kServicer);
  const gnss::EpochBuffer& theirs = context.gnss.waiting(gnss::Receiver::kTarget);
  for (std::size_t k = 0; k < ours.size(); ++k) {
    const GpsTime tag = ours[k].receiver_time;
    if (tag <= decided_until_ || tag > context.now) continue;
    if (theirs.find(tag) != nullptr) {
      alone_in_a_row_ = 0;
      // A pair behind an epoch that still waits may be in the queue already.
      const Status filed = records.file(tag, 0);
      if (filed != Status::kOk && filed != Status::kBadSequence) return;
    } else if (context.now - tag < pair_wait_) {
      // A silent target is not waited for: the images of a camera would be replaced by newer ones meanwhile. An epoch
      // that arrives all the same is used if the filter has not passed it.
      if (alone_in_a_row_ >= kSilentAfter) break;
      if (!owed_) owed_ = tag;
    } else {
      ++alone_;
      if (alone_in_a_row_ < kSilentAfter) ++alone_in_a_row_;
    }
    if (!owed_) decided_until_ = tag;
  }
}

void CdgnssSource::process_record(const Record& record, Context& context, filter::RelativeNavigationFilter& filter) {
  const gnss::ObservationEpoch* ours = context.gnss.waiting(gnss::Receiver::kServicer).find(record.time);
  const gnss::ObservationEpoch* theirs = context.gnss.waiting(gnss::Receiver::kTarget).find(record.time);
  if (ours == nullptr || theirs == nullptr) return;
  const auto servicer_clock_m = context.gnss.servicer_clock_m(record.time);
  if (!servicer_clock_m) return aiding_.count_no_solution();
  const auto frame = gnss::EarthFrame::at(record.time, filter.settings().earth);
  const PairEpoch pair{.ours = *ours,
                       .theirs = *theirs,
                       .servicer_clock_m = *servicer_clock_m,
                       .R_eci_servicer = context.platform.servicer_attitude.R_eci_body_at(record.time),
                       .R_eci_target = context.platform.target_attitude.R_eci_body_at(record.time),
                       .ephemerides = context.gnss.ephemerides(),
                       .frame = frame};
  aiding_.process(pair, filter);
}

void CdgnssSource::stop(GpsTime now, filter::RelativeNavigationFilter& filter) {
  aiding_.stop(now, filter);
  owed_.reset();
}

void CdgnssSource::report(const Telemetry& telemetry) const {
  const CarrierCounters& counters = aiding_.counters();
  const AmbiguityReport& ambiguities = aiding_.report();
  const CarrierUpdate& last = aiding_.last_update();
  telemetry_gnss message{};
  message.step = telemetry.step;
  message.epoch_gps_ns = telemetry.filter.epoch().ns;
  message.pairs = counters.pairs;
  message.alone = alone_;
  message.too_late = telemetry.gnss.too_late();
  message.no_solution = counters.no_solution;
  message.codes_refused = counters.codes_rejected;
  message.phases_refused = counters.phases_rejected;
  message.slips = counters.slips;
  message.restarts = counters.restarts;
  message.tracked = ambiguities.tracked;
  message.fixed = ambiguities.fixed;
  message.fixes = ambiguities.fixes;
  message.releases = ambiguities.releases;
  message.obstacle = static_cast<std::int8_t>(ambiguities.rejection_reason);
  message.success_rate = ambiguities.success_rate;
  message.ratio = ambiguities.ratio;
  message.codes_used = last.codes_used;
  message.phases_used = last.phases_used;
  message.code_nis = last.code_nis;
  message.phase_nis = last.phase_nis;
  if (telemetry.filter.has_relative()) {
    messaging::copy_lower_triangle(filter::covariance_rtn(telemetry.filter.estimate(), telemetry.filter.servicer()),
                                   message.covariance_rtn);
  }
  message.messages = telemetry.gnss.messages();
  message.messages_refused = telemetry.gnss.messages_refused();
  telemetry.outbox.send(telemetry.now, message);
}

}  // namespace vbar::fsw::measurements
