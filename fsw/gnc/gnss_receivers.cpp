#include "fsw/gnc/gnss_receivers.h"

#include "fsw/gnc/message_fields.h"

namespace vbar::fsw::gnc {
namespace {

using navigation::Receiver;

constexpr std::size_t index_of(Receiver receiver) {
  return static_cast<std::size_t>(receiver);
}

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
  decode(Receiver::kServicer, inbox.gnss_bytes_packets(), inbox, navigation);
  decode(Receiver::kTarget, inbox.crosslink_gnss_bytes_packets(), inbox, navigation);
}

template <class Queue>
void GnssReceivers::decode(Receiver receiver, const Queue& packets, Inbox& inbox,
                           navigation::GnssNavigation& navigation) {
  gnss::ReceiverDecoder& decoder = decoders_[index_of(receiver)];
  for (std::size_t k = 0; k < packets.size(); ++k) {
    const auto& message = packets[k].value;
    if (message.count < 0 || message.count > static_cast<std::int32_t>(sizeof message.data)) {
      inbox.count_bad_content();
      continue;
    }
    for (std::int32_t n = 0; n < message.count; ++n) {
      switch (decoder.push(message.data[n])) {
        case gnss::ReceiverUpdate::kObservations:
          navigation.take(receiver, decoder.observations());
          break;
        case gnss::ReceiverUpdate::kEphemeris:
          navigation.take(decoder.ephemeris());
          break;
        case gnss::ReceiverUpdate::kNone:
        case gnss::ReceiverUpdate::kIonosphere:
        case gnss::ReceiverUpdate::kClock:
        case gnss::ReceiverUpdate::kPosition:
          break;
      }
    }
  }
}

std::int32_t GnssReceivers::messages() const {
  std::uint32_t sum = 0;
  for (const auto& decoder : decoders_) sum += decoder.stream().counters().messages;
  return static_cast<std::int32_t>(sum & 0x7FFF'FFFFU);
}

std::int32_t GnssReceivers::refused() const {
  std::uint32_t sum = 0;
  for (const auto& decoder : decoders_) sum += decoder.stream().counters().bad_checksum + decoder.counters().refused;
  return static_cast<std::int32_t>(sum & 0x7FFF'FFFFU);
}

}  // namespace vbar::fsw::gnc
