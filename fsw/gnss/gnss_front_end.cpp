#include "fsw/gnss/gnss_front_end.h"

namespace vbar::fsw::gnss {

void GnssFrontEnd::hear(Receiver receiver, GpsTime tag) {
  std::optional<Heard>& heard = heard_[static_cast<std::size_t>(receiver)];
  if (!heard) {
    heard = Heard{.newest = tag};
  } else if (tag > heard->newest) {
    heard = Heard{.newest = tag, .interval = tag - heard->newest};
  }
}

void GnssFrontEnd::decode(messaging::Inbox& inbox, GpsTime oldest) {
  const auto file = [&](Receiver receiver, const gnss::ObservationEpoch& epoch) {
    hear(receiver, epoch.receiver_time);
    gnss::EpochBuffer& buffer = waiting_[static_cast<std::size_t>(receiver)];
    if (epoch.receiver_time < oldest || buffer.file(epoch) != Status::kOk) ++too_late_;
  };
  // A refused set of ephemerides is invalid or unsupported: no information is lost.
  const auto keep = [&](const gnss::Ephemeris& ephemeris) { static_cast<void>(ephemerides_.put(ephemeris)); };
  decoders_.decode(inbox, file, keep);
}

}  // namespace vbar::fsw::gnss
