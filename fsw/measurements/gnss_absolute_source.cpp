#include "fsw/measurements/gnss_absolute_source.h"

#include "fsw/messaging/message_fields.h"

namespace vbar::fsw::measurements {

Result<gnss::SinglePoint> GnssAbsoluteAiding::process(const gnss::ObservationEpoch& epoch,
                                                      const std::optional<Matrix3>& R_eci_body,
                                                      const gnss::EphemerisStore& ephemerides,
                                                      const gnss::EarthFrame& frame,
                                                      filter::RelativeNavigationFilter& filter) {
  const GpsTime tag = epoch.receiver_time;
  if (tag != filter.epoch()) return Status::kNotReady;
  if (!aid_.is_on()) aid_.go_to(AidState::kWaiting, tag);
  watch(tag);
  const Result<gnss::SinglePoint> point = gnss::single_point(epoch, ephemerides, frame, range_errors_);
  if (!point.ok()) {
    ++counters_.no_solution;
    return point;
  }
  filter::AbsolutePosition position;
  position.position_eci = point.value().position_eci;
  position.covariance_m2 = point.value().covariance_m2;
  if (R_eci_body) {
    position.position_eci -= *R_eci_body * antenna_body_m_;
  } else {
    position.covariance_m2 += antenna_body_m_.squaredNorm() / 3.0 * Matrix3::Identity();
  }
  // The position is that at the instant of reception, the tag that of the receiver clock.
  position.early_s = point.value().clock_m / gnss::kSpeedOfLight;
  const bool was_started = filter.absolute_orbit().started();
  const bool is_accepted = filter.update_absolute_orbit(position);
  if (was_started) aid_.consistency().add(filter.absolute_orbit().nis(), 3);
  if (!is_accepted) {
    ++counters_.rejected;
    if (!filter.absolute_orbit().started()) aid_.go_to(AidState::kFailed, tag);
    return point;
  }
  ++counters_.used;
  last_accepted_ = tag;
  aid_.go_to(filter.absolute_orbit().started() ? AidState::kAiding : AidState::kStarting, tag);
  return point;
}

void GnssAbsoluteAiding::watch(GpsTime now) {
  if (aid_.state() == AidState::kAiding && now - last_accepted_ > kSilence) aid_.go_to(AidState::kSuspended, now);
}

bool is_valid(const receiver_configuration& configuration) {
  return messaging::vector(configuration.antenna_body_m).norm() < 100.0;
}

/// Satellites are placed by the Earth orientation.
bool GnssAbsoluteSource::configure(const Configuration& configuration) {
  const auto* receiver = configuration.telecommands.in_force<receiver_configuration>();
  if (receiver == nullptr || configuration.telecommands.in_force<earth_configuration>() == nullptr) return false;
  aiding_.set_antenna(messaging::vector(receiver->antenna_body_m));
  return true;
}

void GnssAbsoluteSource::collect(Context& context, RecordFiler records) {
  const gnss::EpochBuffer& epochs = context.gnss.waiting(gnss::Receiver::kServicer);
  for (std::size_t k = 0; k < epochs.size(); ++k) {
    const GpsTime tag = epochs[k].receiver_time;
    if (tag <= filed_until_ || tag > context.now) continue;
    if (records.file(tag, 0) == Status::kOk) filed_until_ = tag;
  }
}

void GnssAbsoluteSource::process_record(const Record& record, Context& context,
                                        filter::RelativeNavigationFilter& filter) {
  const gnss::ObservationEpoch* epoch = context.gnss.waiting(gnss::Receiver::kServicer).find(record.time);
  if (epoch == nullptr) return;
  const auto frame = gnss::EarthFrame::at(record.time, filter.settings().earth);
  const auto R_eci_body = context.platform.servicer_attitude.R_eci_body_at(record.time);
  const auto point = aiding_.process(*epoch, R_eci_body, context.gnss.ephemerides(), frame, filter);
  if (point.ok()) context.gnss.keep_servicer_clock(record.time, point.value().clock_m);
}

}  // namespace vbar::fsw::measurements
