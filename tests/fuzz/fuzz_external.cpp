// The exchange with a sensor in another process, at both ends. Promises: one std::runtime_error, or an answer or a
// truth whose packets are checked, and a batch that encodes back to the same packets.
//
// The input is a list of packets: kind, two bytes of length and fields. Those of a known kind are given header, type
// hash and CRC, which a fuzzer does not guess.

#include <algorithm>
#include <array>
#include <stdexcept>

#include "fsw/packets/messages.h"
#include "hil_drivers/external/exchange.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

namespace external = vbar::external;
namespace packets = vbar::fsw::packets;
using packets::Apid;
using vbar::twins::Packet;

constexpr std::array kApids{Apid::kSourceStart, Apid::kTrueEarth,    Apid::kTrueState,       Apid::kSourceCommand,
                            Apid::kTick,        Apid::kSourceAnswer, Apid::kRangeMeasurement};

template <class Message>
Packet packet_with(std::span<const std::uint8_t> fields) {
  packets::PacketHeader header;
  header.apid = packets::MessageTraits<Message>::kApid;
  header.spacecraft = fields.empty() ? std::uint8_t{1} : fields.front();
  Packet packet(packets::kMaxPacketBytes);
  // The type hash of an empty message, then the fields of the input as far as they reach.
  const auto size = packets::encode(header, Message{}, packet);
  packet.resize(size.value());
  std::vector<std::uint8_t> payload(packet.begin() + packets::kPacketHeaderBytes,
                                    packet.end() - packets::kPacketCrcBytes);
  std::copy_n(fields.begin(), std::min(fields.size(), payload.size() - 8), payload.begin() + 8);
  packet.resize(packets::kMaxPacketBytes);
  packet.resize(packets::write_packet(header, payload, packet).value());
  return packet;
}

Packet packet_of(Apid apid, std::span<const std::uint8_t> fields) {
  Packet packet;
  packets::for_each_message([&]<class Message>() {
    if (packets::MessageTraits<Message>::kApid == apid) packet = packet_with<Message>(fields);
  });
  return packet;
}

std::vector<Packet> packets_in(std::span<const std::uint8_t> data) {
  std::vector<Packet> all;
  while (data.size() >= 3) {
    const std::size_t kind = data[0];
    const std::size_t size = std::min<std::size_t>((std::size_t{data[1]} << 8U) + data[2], data.size() - 3);
    const auto fields = data.subspan(3, size);
    // A packet of the input's own bytes for the other numbers.
    all.push_back(kind < kApids.size() ? packet_of(kApids[kind], fields) : Packet(fields.begin(), fields.end()));
    data = data.subspan(3 + size);
  }
  return all;
}

void try_batch(std::span<const Packet> sent) {
  external::SpacecraftNumbers numbers;
  for (int number = 0; number < 256; ++number)
    numbers.add("s" + std::to_string(number), static_cast<std::uint8_t>(number));
  external::Batch batch;
  try {
    batch = external::batch_of(sent, numbers);
  } catch (const std::runtime_error&) {
    return;
  }
  const auto again = external::packets_of(batch, 0, numbers);
  const auto received = external::batch_of(again, numbers);
  VBAR_FUZZ_EXPECT(external::packets_of(received, 0, numbers) == again);
}

void try_answer(std::vector<Packet> sent) {
  external::Answer answer;
  try {
    answer = external::answer_of(std::move(sent));
  } catch (const std::runtime_error&) {
    return;
  }
  const std::array allowed{Apid::kRangeMeasurement};
  for (const Packet& packet : answer.packets)
    if (external::fault_of(packet, allowed, 1, 0).empty())
      VBAR_FUZZ_EXPECT(packets::decode<vbar::range_measurement>(packets::parse_packet(packet).value()).ok());
}

void try_truth(std::span<const Packet> sent) {
  external::SpacecraftNumbers numbers;
  for (int number = 0; number < 3; ++number)
    numbers.add("s" + std::to_string(number), static_cast<std::uint8_t>(number));
  external::StatedTruth stated;
  try {
    stated = external::truth_of(sent, {}, numbers);
  } catch (const std::runtime_error&) {
    return;
  }
  VBAR_FUZZ_EXPECT(stated.truth.spacecraft.size() <= 3);
  const auto again = external::truth_of(external::packets_of(stated.truth, numbers), {}, numbers);
  VBAR_FUZZ_EXPECT(external::packets_of(again.truth, numbers) == external::packets_of(stated.truth, numbers));
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<Packet> sent = packets_in({data, size});
  try_batch(sent);
  try_answer(sent);
  try_truth(sent);
  return 0;
}
