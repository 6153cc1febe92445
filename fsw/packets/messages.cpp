#include "fsw/packets/messages.h"

#include "fsw/packets/big_endian.h"

namespace vbar::fsw::packets {
namespace {

constexpr std::size_t kTypeHashBytes = 8;

}  // namespace

template <class Message>
Result<std::size_t> encode(PacketHeader header, const Message& message, std::span<std::uint8_t> out) {
  if (!all_finite(message)) return Status::kNotFinite;
  const auto payload_bytes = static_cast<std::size_t>(message.getEncodedSize());
  if (payload_bytes > kMaxPayloadBytes || out.size() < kPacketHeaderBytes + payload_bytes + kPacketCrcBytes) {
    return Status::kTooLong;
  }
  // Encoded in place: write_packet recognises this and does not copy.
  const std::span<std::uint8_t> payload = out.subspan(kPacketHeaderBytes, payload_bytes);
  if (message.encode(payload.data(), 0, static_cast<int>(payload_bytes)) != static_cast<int>(payload_bytes)) {
    return Status::kTooLong;
  }
  header.apid = MessageTraits<Message>::kApid;
  header.flags = SequenceFlags::kUnsegmented;
  return write_packet(header, payload, out);
}

template <class Message>
Result<Message> decode(const PacketView& packet) {
  if (packet.header.apid != MessageTraits<Message>::kApid) return Status::kWrongType;
  if (packet.header.flags != SequenceFlags::kUnsegmented) return Status::kBadSequence;
  if (packet.payload.size() < kTypeHashBytes) return Status::kTooShort;
  if (read_big_endian<std::uint64_t>(packet.payload, 0) != static_cast<std::uint64_t>(Message::getHash())) {
    return Status::kWrongType;
  }
  Message message{};
  const auto expected_bytes = static_cast<std::size_t>(message.getEncodedSize());
  if (packet.payload.size() < expected_bytes) return Status::kTooShort;
  if (packet.payload.size() > expected_bytes) return Status::kTooLong;
  if (message.decode(packet.payload.data(), 0, static_cast<int>(expected_bytes)) != static_cast<int>(expected_bytes)) {
    return Status::kWrongType;
  }
  if (!all_finite(message)) return Status::kNotFinite;
  return message;
}

#define VBAR_MESSAGE(type, enumerator, number, route)                                            \
  template Result<std::size_t> encode<type>(PacketHeader, const type&, std::span<std::uint8_t>); \
  template Result<type> decode<type>(const PacketView&);
VBAR_FOR_EACH_MESSAGE(VBAR_MESSAGE)
#undef VBAR_MESSAGE

const char* message_name(Apid apid) {
  const char* name = nullptr;
  for_each_message([&]<class Message>() {
    if (MessageTraits<Message>::kApid == apid) name = Message::getTypeName();
  });
  return name;
}

}  // namespace vbar::fsw::packets
