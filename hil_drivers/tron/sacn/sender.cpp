#include "hil_drivers/tron/sacn/sender.h"

#include <algorithm>
#include <stdexcept>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/endian/conversion.hpp>
#include <fmt/format.h>

#include "hil_drivers/tron/sacn/levels.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::tron::sacn {
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
