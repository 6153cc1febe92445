#include "hil_drivers/tron/protocols/sacn.h"

#include <algorithm>
#include <stdexcept>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/endian/conversion.hpp>
#include <fmt/format.h>

#include "host_sim/engine/random_stream.h"

namespace vbar::tron::sacn {

namespace {

namespace endian = boost::endian;

constexpr std::size_t kRootAt = 16, kCidAt = 22, kFramingAt = 38, kNameAt = 44, kPriorityAt = 108,
                      kSynchronisationAt = 109, kSequenceAt = 111, kOptionsAt = 112, kUniverseAt = 113, kDmpAt = 115,
                      kCountAt = 123, kStartCodeAt = 125;
constexpr std::uint16_t kFlags = 0x7000;
constexpr std::uint8_t kPreview = 0x80, kTerminated = 0x40, kForced = 0x20;

// What is the same in all data packets.
struct FixedByte {
  std::size_t at;
  std::uint8_t value;
};
constexpr std::array<FixedByte, 30> kFixedBytes{{
    {0, 0},    {1, 0x10}, {2, 0},    {3, 0},  {4, 'A'}, {5, 'S'},    {6, 'C'}, {7, '-'}, {8, 'E'}, {9, '1'},
    {10, '.'}, {11, '1'}, {12, '7'}, {13, 0}, {14, 0},  {15, 0},     {18, 0},  {19, 0},  {20, 0},  {21, 4},
    {40, 0},   {41, 0},   {42, 0},   {43, 2}, {117, 2}, {118, 0xA1}, {119, 0}, {120, 0}, {121, 0}, {122, 1},
}};

[[noreturn]] void refuse(std::size_t at, const std::string& what) {
  throw std::invalid_argument(fmt::format("sACN packet, byte {}: {}", at, what));
}

void check(const DataPacket& packet) {
  const auto require = [](bool is_met, const std::string& rule) {
    if (!is_met) throw std::invalid_argument("sACN packet: " + rule);
  };
  require(packet.source_name.size() < kSourceNameBytes, "the name of the source has at most 63 bytes");
  require(packet.source_name.find('\0') == std::string::npos, "the name of the source contains NUL");
  require(packet.priority <= kMaxPriority, fmt::format("priority {}; at most {}", packet.priority, kMaxPriority));
  require(packet.universe >= 1 && packet.universe <= kMaxUniverse,
          fmt::format("universe {}; 1 to {}", packet.universe, kMaxUniverse));
  require(packet.slots.size() <= kMaxSlots, fmt::format("{} slots; at most {}", packet.slots.size(), kMaxSlots));
}

void store_length(Bytes& datagram, std::size_t at) {
  endian::store_big_u16(datagram.data() + at, static_cast<std::uint16_t>(kFlags | (datagram.size() - at)));
}

/// Checks the flags and the length of a layer against the end of the packet, which the root layer states.
void check_length(ByteSpan datagram, std::size_t at, std::size_t end) {
  const std::uint16_t word = endian::load_big_u16(datagram.data() + at);
  if ((word & 0xF000U) != kFlags) refuse(at, "the flags of a layer are not 7");
  if ((word & 0x0FFFU) != end - at)
    refuse(at, fmt::format("a layer of {} bytes where the packet has {}", word & 0x0FFFU, end - at));
}

std::size_t end_of_packet(ByteSpan datagram) {
  if (datagram.size() < kSlotsAt)
    refuse(0, fmt::format("{} bytes; a data packet has at least {}", datagram.size(), kSlotsAt));
  for (const FixedByte& fixed : kFixedBytes)
    if (datagram[fixed.at] != fixed.value)
      refuse(fixed.at,
             fmt::format("{:#04x} instead of {:#04x}: not a data packet of E1.31", datagram[fixed.at], fixed.value));
  const std::size_t end = kRootAt + (endian::load_big_u16(datagram.data() + kRootAt) & 0x0FFFU);
  if (end < kSlotsAt || end > datagram.size())
    refuse(kRootAt, fmt::format("the packet states {} bytes, {} have arrived", end, datagram.size()));
  for (const std::size_t at : {kRootAt, kFramingAt, kDmpAt}) check_length(datagram, at, end);
  return end;
}

}  // namespace

void encode_data_packet(const DataPacket& packet, Bytes& datagram) {
  check(packet);
  datagram.assign(kSlotsAt, 0);
  for (const FixedByte& fixed : kFixedBytes) datagram[fixed.at] = fixed.value;
  std::ranges::copy(packet.cid, datagram.begin() + kCidAt);
  std::ranges::copy(packet.source_name, datagram.begin() + kNameAt);
  datagram[kPriorityAt] = packet.priority;
  endian::store_big_u16(datagram.data() + kSynchronisationAt, packet.synchronisation);
  datagram[kSequenceAt] = packet.sequence;
  datagram[kOptionsAt] =
      static_cast<std::uint8_t>((packet.is_preview ? kPreview : 0) | (packet.is_terminated ? kTerminated : 0) |
                                (packet.is_synchronisation_forced ? kForced : 0));
  endian::store_big_u16(datagram.data() + kUniverseAt, packet.universe);
  endian::store_big_u16(datagram.data() + kCountAt, static_cast<std::uint16_t>(1 + packet.slots.size()));
  datagram[kStartCodeAt] = packet.start_code;
  datagram.insert(datagram.end(), packet.slots.begin(), packet.slots.end());
  for (const std::size_t at : {kRootAt, kFramingAt, kDmpAt}) store_length(datagram, at);
}

DataPacket decode_data_packet(ByteSpan datagram) {
  const std::size_t end = end_of_packet(datagram);
  DataPacket packet;
  std::ranges::copy(datagram.subspan(kCidAt, packet.cid.size()), packet.cid.begin());
  const ByteSpan name = datagram.subspan(kNameAt, kSourceNameBytes);
  const auto name_end = std::ranges::find(name, 0);
  if (name_end == name.end()) refuse(kNameAt, "the name of the source does not end");
  packet.source_name.assign(name.begin(), name_end);
  packet.priority = datagram[kPriorityAt];
  if (packet.priority > kMaxPriority)
    refuse(kPriorityAt, fmt::format("priority {}; at most {}", packet.priority, kMaxPriority));
  packet.synchronisation = endian::load_big_u16(datagram.data() + kSynchronisationAt);
  packet.sequence = datagram[kSequenceAt];
  const std::uint8_t options = datagram[kOptionsAt];
  packet.is_preview = (options & kPreview) != 0;
  packet.is_terminated = (options & kTerminated) != 0;
  packet.is_synchronisation_forced = (options & kForced) != 0;
  packet.universe = endian::load_big_u16(datagram.data() + kUniverseAt);
  if (packet.universe < 1 || packet.universe > kMaxUniverse)
    refuse(kUniverseAt, fmt::format("universe {}; 1 to {}", packet.universe, kMaxUniverse));
  const std::size_t count = endian::load_big_u16(datagram.data() + kCountAt);
  if (count < 1 || count > 1 + kMaxSlots || kStartCodeAt + count != end)
    refuse(kCountAt, fmt::format("{} values where the packet has {}", count, end - kStartCodeAt));
  packet.start_code = datagram[kStartCodeAt];
  packet.slots.assign(datagram.begin() + kSlotsAt, datagram.begin() + static_cast<std::ptrdiff_t>(end));
  return packet;
}

namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

}  // namespace

Cid cid_of_bench(const std::string& bench) {
  Cid cid;
  boost::endian::store_big_u64(cid.data(), engine::fnv1a_64("vbar/tron/sacn/" + bench));
  boost::endian::store_big_u64(cid.data() + 8, engine::fnv1a_64(bench + "/sacn/tron/vbar"));
  cid[6] = static_cast<std::uint8_t>((cid[6] & 0x0FU) | 0x80U);
  cid[8] = static_cast<std::uint8_t>((cid[8] & 0x3FU) | 0x80U);
  return cid;
}

struct Sender::State {
  State(const SacnSettings& asked, const std::string& bench) : settings(asked), socket(context) {
    error_code error;
    const auto address = asio::ip::make_address_v4(settings.address, error);
    if (!error) socket.open(udp::v4(), error);
    if (error) throw std::runtime_error(fmt::format("{}: {}", description(), error.message()));
    lights = {address, settings.port};
    packet.cid = cid_of_bench(bench);
    packet.source_name = ("vbar " + bench).substr(0, kSourceNameBytes - 1);
    packet.priority = static_cast<std::uint8_t>(std::clamp(settings.priority, 0, kMaxPriority));
    packet.universe = settings.universe;
    packet.slots.assign(kMaxSlots, 0);
    encode_data_packet(packet, datagram);  // rejects what E1.31 does not permit
  }

  [[nodiscard]] std::string description() const {
    return fmt::format("lights at {}:{}, universe {}", settings.address, settings.port, settings.universe);
  }

  error_code send() {
    encode_data_packet(packet, datagram);
    error_code error;
    socket.send_to(asio::buffer(datagram), lights, 0, error);
    ++packet.sequence;
    ++packets;
    // A receiver that is not there reports itself with the packet after; another one may come.
    return error == asio::error::connection_refused ? error_code() : error;
  }

  void send_or_throw() {
    if (const error_code error = send())
      throw std::runtime_error(fmt::format("{}: {}", description(), error.message()));
  }

  SacnSettings settings;
  asio::io_context context;
  udp::socket socket;
  udp::endpoint lights;
  DataPacket packet;
  Bytes datagram;
  bool is_active = false;
  std::uint64_t packets = 0;
};

Sender::Sender(const SacnSettings& settings, const std::string& bench)
    : state_(std::make_unique<State>(settings, bench)) {}

Sender::~Sender() {
  terminate();
}

void Sender::send(std::span<const std::uint16_t> values) {
  const int first = state_->settings.start_slot;
  if (first < 1 || static_cast<std::size_t>(first - 1) + 2 * values.size() > kMaxSlots)
    throw std::invalid_argument(fmt::format("{}: {} values from slot {} do not fit into {} slots", description(),
                                            values.size(), first, kMaxSlots));
  std::ranges::fill(state_->packet.slots, 0);
  store_values(values, first, state_->packet.slots);
  state_->is_active = true;
  state_->send_or_throw();
}

void Sender::keep_alive() {
  if (state_->is_active) state_->send_or_throw();
}

void Sender::terminate() noexcept {
  if (!state_->is_active) return;
  state_->is_active = false;
  try {
    state_->packet.is_terminated = true;
    for (int k = 0; k < kTerminatedPackets; ++k) state_->send();
  } catch (...) {
    // Without memory for a packet the receiver's time-out ends the source.
  }
  state_->packet.is_terminated = false;
}

std::uint64_t Sender::packets() const {
  return state_->packets;
}

std::string Sender::description() const {
  return state_->description();
}

}  // namespace vbar::tron::sacn
