// parse_packet and decode of every message on arbitrary bytes. Promises: nothing is read past the end, and what decodes
// encodes back to the same bytes; no telecommand is authentic.
//
// A fuzzer does not guess a CRC or a type hash. So the input is tried as it is, and also as a payload (its first byte
// chooses the message) that is given the right header, type hash and CRC.

#include <algorithm>
#include <array>
#include <span>

#include "fsw/packets/big_endian.h"
#include "fsw/packets/messages.h"
#include "fsw/packets/security_trailer.h"
#include "fsw/packets/segmentation.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

namespace packets = vbar::fsw::packets;
using Packet = std::array<std::uint8_t, packets::kMaxPacketBytes>;

template <class Message>
void expect_same_bytes_back(std::span<const std::uint8_t> bytes, const packets::PacketView& packet) {
  const vbar::fsw::Result<Message> message = packets::decode<Message>(packet);
  if (!message.ok()) return;
  Packet again{};
  const vbar::fsw::Result<std::size_t> size = packets::encode(packet.header, message.value(), again);
  VBAR_FUZZ_EXPECT(size.ok() && size.value() == bytes.size());
  VBAR_FUZZ_EXPECT(std::equal(bytes.begin(), bytes.end(), again.begin()));
}

/// Without the key no telecommand is accepted; what is not one is left as it is.
void try_authentication(std::span<const std::uint8_t> bytes, const packets::PacketView& packet) {
  packets::TelecommandAuthentication authentication;
  packets::TelecommandSecurity security;
  security.key.fill(0xA5);
  authentication.require(security);
  const vbar::fsw::Result<packets::PacketView> verified = authentication.verify(bytes, packet);
  VBAR_FUZZ_EXPECT(verified.ok() != packets::is_telecommand_apid(packet.header.apid));
  VBAR_FUZZ_EXPECT(!verified.ok() || verified.value().payload.size() == packet.payload.size());
}

void try_packet(std::span<const std::uint8_t> bytes) {
  static packets::Reassembler<4000> reassembler({packets::Apid::kTick, 0, 0});
  const vbar::fsw::Result<packets::PacketView> packet = packets::parse_packet(bytes);
  if (!packet.ok()) return;
  VBAR_FUZZ_EXPECT(packet.value().payload.data() >= bytes.data());
  VBAR_FUZZ_EXPECT(packet.value().payload.data() + packet.value().payload.size() <= bytes.data() + bytes.size());
  packets::for_each_message([&]<class Message>() { expect_same_bytes_back<Message>(bytes, packet.value()); });
  static_cast<void>(reassembler.push(packet.value()));
  try_authentication(bytes, packet.value());
}

/// The input after its first byte as fields of message number `chosen`, type hash in front.
template <class Message>
void try_fields(std::span<const std::uint8_t> fields) {
  packets::PacketHeader header;
  header.apid = packets::MessageTraits<Message>::kApid;
  std::array<std::uint8_t, packets::kMaxPayloadBytes> payload{};
  packets::write_big_endian(static_cast<std::uint64_t>(Message::getHash()), std::span(payload), 0);
  const std::size_t size = std::min(fields.size(), payload.size() - 8);
  std::copy_n(fields.begin(), size, payload.begin() + 8);
  Packet packet{};
  const auto written = packets::write_packet(header, std::span(payload).first(size + 8), packet);
  VBAR_FUZZ_EXPECT(written.ok());
  try_packet(std::span(packet).first(written.value()));
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> bytes(data, size);
  try_packet(bytes);
  if (bytes.empty()) return 0;
  int number = 0;
  packets::for_each_message([&]<class Message>() {
    if (bytes[0] == number++) try_fields<Message>(bytes.subspan(1));
  });
  return 0;
}
