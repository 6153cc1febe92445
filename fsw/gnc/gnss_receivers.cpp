#include "fsw/gnc/gnss_receivers.h"

#include "fsw/gnc/message_fields.h"

namespace vbar::fsw::gnc {
namespace {

using navigation::Receiver;

// Maximum angular rate of a spacecraft body, rad/s.
constexpr double kGreatestRate = 10.0;

/// False for a quaternion whose length differs from one by more than a part in a thousand, or for an impossible rate.
template <class Message>
bool attitude_of(const Message& message, navigation::AttitudeSample& sample) {
  if (!is_rotation(message.q_eci_body)) return false;
  sample.R_eci_body = rotation(message.q_eci_body);
  sample.rate_body = vector(message.rate_body);
  return sample.rate_body.squaredNorm() <= kGreatestRate * kGreatestRate;
}

template <class Queue>
void take_attitudes(Receiver receiver, GpsTime now, const Queue& packets, Inbox& inbox,
                    navigation::GnssNavigation& navigation) {
  for (std::size_t k = 0; k < packets.size(); ++k) {
    navigation::AttitudeSample sample;
    sample.time = packets[k].tag.time;
    if (sample.time > now) {
      inbox.count_unusable_time();
    } else if (attitude_of(packets[k].value, sample)) {
      navigation.take(receiver, sample);
    } else {
      inbox.count_bad_content();
    }
  }
}

}  // namespace

void GnssReceivers::feed(GpsTime now, Inbox& inbox, navigation::GnssNavigation& navigation) {
  take_attitudes(Receiver::kServicer, now, inbox.attitudes(), inbox, navigation);
  take_attitudes(Receiver::kTarget, now, inbox.crosslink_attitudes(), inbox, navigation);
  decoders_.decode(
      inbox, [&](Receiver receiver, const gnss::ObservationEpoch& epoch) { navigation.take(receiver, epoch); },
      [&](const gnss::Ephemeris& ephemeris) { navigation.take(ephemeris); });
}

}  // namespace vbar::fsw::gnc
