#include "fsw/messaging/inbox.h"

namespace vbar::fsw::messaging {

using packets::PacketView;
using packets::RouteKind;

Inbox::Inbox(std::uint8_t spacecraft)
    : spacecraft_(spacecraft), images_{{imaging::ImageAssembly(0), imaging::ImageAssembly(1)}} {
  static_assert(packets::kCameras == 2);
  for (imaging::ImageAssembly& image : images_) image.accept_until(GpsTime{-1});
}

Status Inbox::receive(std::span<const std::uint8_t> bytes) {
  const Result<PacketView> packet = packets::parse_packet(bytes);
  const Status status = packet.ok() ? file(bytes, packet.value()) : packet.status();
  count(status);
  return status;
}

Status Inbox::file(std::span<const std::uint8_t> bytes, const PacketView& received) {
  if (received.header.spacecraft != spacecraft_) return Status::kInvalidArgument;
  const Result<PacketView> verified = authentication_.verify(bytes, received);
  if (!verified.ok()) return verified.status();
  const PacketView& packet = verified.value();
  if (!is_usable(packet.header.time)) return Status::kOutOfRange;
  Status status = Status::kWrongType;  // result for an unknown APID
  packets::for_each_message([&]<class Message>() {
    if (packet.header.apid == packets::MessageTraits<Message>::kApid) status = take<Message>(packet);
  });
  return status;
}

template <class Message>
Status Inbox::take(const PacketView& packet) {
  constexpr RouteKind kKind = packets::MessageTraits<Message>::kRoute.kind;
  if constexpr (kKind == RouteKind::kFromFlight || kKind == RouteKind::kBoard) {
    return Status::kWrongType;
  } else {
    const Result<Message> message = packets::decode<Message>(packet);
    if (!message.ok()) return message.status();
    const packets::PacketHeader& header = packet.header;
    if constexpr (kKind == RouteKind::kQueue) {
      const FilingTag tag{header.time, header.unit, header.sequence_count};
      return std::get<Queue<Message>>(queues_).file(tag, message.value());
    } else {
      static_assert(kKind == RouteKind::kSpecial);
      return take_special(header, message.value());
    }
  }
}

Status Inbox::take_special(const packets::PacketHeader& /*header*/, const tick& message) {
  const Duration period{message.period_ns};
  if (!is_usable(period)) return Status::kOutOfRange;
  step_period_ = period;
  return Status::kOk;
}

Status Inbox::take_special(const packets::PacketHeader& header, const image_tile& message) {
  if (header.unit >= images_.size()) return Status::kWrongType;
  return images_[header.unit].take(header.time, header.unit, message);
}

void Inbox::count(Status status) {
  switch (status) {
    case Status::kOk:
      ++counters_.accepted;
      break;
    case Status::kBadChecksum:
      ++counters_.rejected_checksum;
      break;
    case Status::kWrongType:
      ++counters_.rejected_type;
      break;
    case Status::kTooShort:
    case Status::kTooLong:
      ++counters_.rejected_length;
      break;
    case Status::kNotFinite:
    case Status::kOutOfRange:
      ++counters_.rejected_content;
      break;
    case Status::kFull:
      ++counters_.dropped_full;
      break;
    case Status::kBadSequence:
    case Status::kInvalidArgument:
    case Status::kDidNotConverge:
    case Status::kSingular:
    case Status::kUnsafe:
    case Status::kNotReady:
      ++counters_.rejected_other;
      break;
  }
}

void Inbox::clear(GpsTime next_step) {
  for (imaging::ImageAssembly& image : images_) {
    if (image.has_image()) image.clear();
    image.accept_until(next_step);
  }
  std::apply([](auto&... queue) { (queue.clear(), ...); }, queues_);
}

}  // namespace vbar::fsw::messaging
