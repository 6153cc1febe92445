#include "tests/integration/experiment3/receiver_stream.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "fsw/packets/messages.h"

namespace vbar::test {
namespace {

namespace packets = fsw::packets;

constexpr std::size_t kCheckSumBytes = 4;

// The manufacturer's CRC-32, bit by bit (OM-20000129, "32-bit CRC").
std::uint32_t check_sum(const Bytes& bytes) {
  std::uint32_t crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0U ? (crc >> 1U) ^ 0xEDB88320U : crc >> 1U;
  }
  return crc;
}

/// Takes the bytes of one kind of packets out of `all`; their header goes to `header`.
template <class Message>
Bytes take_out(std::vector<pil::Packet>& all, packets::Apid apid, packets::PacketHeader& header) {
  Bytes bytes;
  std::vector<pil::Packet> others;
  for (pil::Packet& packet : all) {
    const packets::PacketView view = packets::parse_packet(packet).value();
    if (view.header.apid != apid) {
      others.push_back(std::move(packet));
      continue;
    }
    header = view.header;
    const Message message = packets::decode<Message>(view).value();
    bytes.insert(bytes.end(), message.data, message.data + message.count);
  }
  all = std::move(others);
  return bytes;
}

/// Puts `bytes` back, before the tick. Another unit number keeps sequence counts apart from those of other steps.
template <class Message>
void put_back(std::vector<pil::Packet>& all, packets::PacketHeader header, const Bytes& bytes) {
  header.unit = 1;
  header.sequence_count = 0;
  for (std::size_t begin = 0; begin < bytes.size(); begin += sizeof(Message::data)) {
    Message message{};
    message.count = static_cast<std::int32_t>(std::min(sizeof message.data, bytes.size() - begin));
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(begin), message.count, message.data);
    pil::Packet packet(packets::kMaxPacketBytes);
    packet.resize(packets::encode(header, message, packet).value());
    all.insert(all.end() - 1, std::move(packet));
    ++header.sequence_count;
  }
}

class SpoilingComputer final : public pil::FlightComputer {
 public:
  SpoilingComputer(std::unique_ptr<pil::FlightComputer> inner, std::uint32_t first, std::uint32_t last,
                   std::function<void(ReceiverBytes&)> spoil)
      : inner_(std::move(inner)), first_(first), last_(last), spoil_(std::move(spoil)) {}

  pil::StepResult step(std::uint32_t step, std::span<const pil::Packet> given) override {
    if (step < first_ || step > last_) return inner_->step(step, given);
    std::vector<pil::Packet> all(given.begin(), given.end());
    packets::PacketHeader ours, theirs;
    ReceiverBytes bytes{take_out<gnss_bytes>(all, packets::Apid::kGnssBytes, ours),
                        take_out<crosslink_gnss_bytes>(all, packets::Apid::kCrosslinkGnssBytes, theirs)};
    spoil_(bytes);
    put_back<gnss_bytes>(all, ours, bytes.servicer);
    put_back<crosslink_gnss_bytes>(all, theirs, bytes.target);
    return inner_->step(step, all);
  }
  [[nodiscard]] pil::LinkStatistics statistics() const override { return inner_->statistics(); }
  [[nodiscard]] std::string description() const override { return inner_->description(); }
  void close() override { inner_->close(); }

 private:
  std::unique_ptr<pil::FlightComputer> inner_;
  std::uint32_t first_;
  std::uint32_t last_;
  std::function<void(ReceiverBytes&)> spoil_;
};

}  // namespace

Wrap spoil_steps(std::uint32_t first, std::uint32_t last, const std::function<void(ReceiverBytes&)>& spoil) {
  return [=](std::unique_ptr<pil::FlightComputer> inner) {
    return std::make_unique<SpoilingComputer>(std::move(inner), first, last, spoil);
  };
}

void edit_messages(Bytes& bytes, const std::function<void(int id, Bytes& message)>& edit) {
  Bytes edited;
  for (std::size_t begin = 0; begin < bytes.size();) {
    const std::uint8_t* header = bytes.data() + begin;
    if (bytes.size() - begin < kOemHeaderBytes || header[0] != 0xAA || header[1] != 0x44 || header[2] != 0x12)
      throw std::logic_error("the bytes to be edited are not whole messages");
    const int id = header[4] + 256 * header[5];
    const std::size_t length = kOemHeaderBytes + header[8] + 256U * header[9];
    Bytes message(header, header + length);
    edit(id, message);
    const std::size_t body = message.size() - kOemHeaderBytes;
    message[8] = static_cast<std::uint8_t>(body & 0xFFU);
    message[9] = static_cast<std::uint8_t>(body >> 8U);
    const std::uint32_t crc = check_sum(message);
    for (unsigned shift = 0; shift < 32U; shift += 8U) message.push_back(static_cast<std::uint8_t>(crc >> shift));
    edited.insert(edited.end(), message.begin(), message.end());
    begin += length + kCheckSumBytes;
  }
  bytes = std::move(edited);
}

}  // namespace vbar::test
