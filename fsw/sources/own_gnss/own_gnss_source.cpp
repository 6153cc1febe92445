#include "fsw/sources/own_gnss/own_gnss_source.h"

#include "fsw/gnc/message_fields.h"

namespace vbar::fsw::sources {

bool is_valid(const receiver_configuration& configuration) {
  return gnc::vector(configuration.antenna_body_m).norm() < 100.0;
}

/// Satellites are placed by the Earth orientation.
bool OwnGnssSource::configure(const Configuration& configuration) {
  const auto* receiver = configuration.telecommands.in_force<receiver_configuration>();
  if (receiver == nullptr || configuration.telecommands.in_force<earth_configuration>() == nullptr) return false;
  aiding_.set_antenna(gnc::vector(receiver->antenna_body_m));
  return true;
}

void OwnGnssSource::collect(Context& context, RecordFiler records) {
  const navigation::EpochBuffer& epochs = context.gnss.waiting(Receiver::kServicer);
  for (std::size_t k = 0; k < epochs.size(); ++k) {
    const GpsTime tag = epochs[k].receiver_time;
    if (tag <= filed_until_ || tag > context.now) continue;
    if (records.file(tag, 0) == Status::kOk) filed_until_ = tag;
  }
}

void OwnGnssSource::process_record(const Record& record, Context& context, filter::RelativeNavigationFilter& filter) {
  const gnss::ObservationEpoch* epoch = context.gnss.waiting(Receiver::kServicer).find(record.time);
  if (epoch == nullptr) return;
  const auto frame = navigation::EarthFrame::at(record.time, filter.settings().earth);
  const auto R_eci_body = context.platform.servicer_attitude.R_eci_body_at(record.time);
  const auto point = aiding_.process(*epoch, R_eci_body, context.gnss.ephemerides(), frame, filter);
  if (point.ok()) context.gnss.keep_servicer_clock(record.time, point.value().clock_m);
}

}  // namespace vbar::fsw::sources
