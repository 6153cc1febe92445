// The whole flight software behind vbar_gnc.h on a hostile stream. The input is a script of packets and steps; packets
// of a message get the right header, type hash and CRC, which a fuzzer does not guess. Promises: nothing is read or
// written out of bounds, every step returns, and every packet that comes out is whole.
//
//   byte 0  255: a step; 254: raw bytes; else the number of a message     byte 1  seconds since the packet before
//   byte 2  payload length / 8                                            then the payload

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <span>
#include <vector>

#include "fsw/messaging/vbar_gnc.h"
#include "fsw/packets/big_endian.h"
#include "fsw/packets/messages.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

namespace packets = vbar::fsw::packets;
using Packet = std::array<std::uint8_t, packets::kMaxPacketBytes>;

constexpr std::size_t kCommandBytes = 3;
constexpr std::int64_t kEpoch_ns = 995'000'000LL * 1'000'000'000LL;

void check_output(void* /*context*/, const std::uint8_t* packet, std::size_t size) {
  VBAR_FUZZ_EXPECT(packets::parse_packet(std::span(packet, size)).ok());
}

/// State in memory of its own, made once and zeroed for every input.
class State {
 public:
  State() : size_(vbar_gnc_state_size()), bytes_(::operator new(size_, std::align_val_t(vbar_gnc_state_alignment()))) {}
  void* begin() {
    std::memset(bytes_, 0, size_);
    VBAR_FUZZ_EXPECT(vbar_gnc_init(bytes_, 1, &check_output, nullptr) == 0);
    return bytes_;
  }

 private:
  std::size_t size_;
  void* bytes_;
};

template <class Message>
void give(void* state, std::int64_t time_ns, std::span<const std::uint8_t> fields) {
  packets::PacketHeader header;
  header.apid = packets::MessageTraits<Message>::kApid;
  header.spacecraft = 1;
  header.time.ns = time_ns;
  std::array<std::uint8_t, packets::kMaxPayloadBytes> payload{};
  packets::write_big_endian(static_cast<std::uint64_t>(Message::getHash()), std::span(payload), 0);
  std::copy_n(fields.begin(), std::min(fields.size(), payload.size() - 8), payload.begin() + 8);
  // As long as the message is; what the script lacks is zero.
  const auto length = static_cast<std::size_t>(Message{}.getEncodedSize());
  Packet packet{};
  const auto size = packets::write_packet(header, std::span(payload).first(std::min(length, payload.size())), packet);
  if (size.ok()) static_cast<void>(vbar_gnc_receive(state, packet.data(), size.value()));
}

void obey(void* state, std::uint8_t what, std::int64_t time_ns, std::span<const std::uint8_t> payload) {
  if (what == 255) {
    static_cast<void>(vbar_gnc_step(state, time_ns));
  } else if (what == 254) {
    static_cast<void>(vbar_gnc_receive(state, payload.data(), payload.size()));
  } else {
    int number = 0;
    packets::for_each_message([&]<class Message>() {
      if (what == number++) give<Message>(state, time_ns, payload);
    });
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static State memory;
  void* const state = memory.begin();
  std::span<const std::uint8_t> rest(data, size);
  std::int64_t time_ns = kEpoch_ns;
  int steps = 0;
  while (rest.size() >= kCommandBytes && steps < 20) {
    const auto command = rest.first(kCommandBytes);
    rest = rest.subspan(kCommandBytes);
    const auto payload = rest.first(std::min<std::size_t>(command[2] * std::size_t{8}, rest.size()));
    rest = rest.subspan(payload.size());
    time_ns += command[1] * 1'000'000'000LL;
    steps += command[0] == 255 ? 1 : 0;
    obey(state, command[0], time_ns, payload);
  }
  return 0;
}
