#include "hil_drivers/tron/bench/lights/light_receiver.h"

#include <stdexcept>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/udp.hpp>
#include <fmt/format.h>

#include "hil_drivers/tron/sacn/levels.h"

namespace vbar::tron::bench {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

// A flood does not hold the emulator for ever.
constexpr int kMaxDatagramsOfCycle = 10000;

}  // namespace

struct LightReceiver::State {
  State(asio::io_context& context, const SacnSettings& settings, std::uint16_t port, LightRig& lights)
      : socket(context),
        start_slot(settings.start_slot),
        rig(lights),
        arbiter(settings.universe),
        datagram(sacn::kMaxPacketBytes + 1) {
    error_code error;
    const auto address = asio::ip::make_address_v4(settings.address, error);
    if (!error) socket.open(udp::v4(), error);
    if (!error) socket.bind(udp::endpoint(address, port), error);
    if (!error) socket.non_blocking(true, error);
    if (error)
      throw std::runtime_error(
          fmt::format("lights: UDP {}:{} is not available: {}", settings.address, port, error.message()));
  }

  void drain(double bench_s) {
    udp::endpoint sender;
    for (int count = 0; count < kMaxDatagramsOfCycle; ++count) {
      error_code error;
      const std::size_t size = socket.receive_from(asio::buffer(datagram), sender, 0, error);
      if (error == asio::error::would_block) return;
      if (error) throw std::runtime_error("lights: " + error.message());
      try {
        arbiter.accept(sacn::decode_data_packet(sacn::ByteSpan(datagram).first(size)), bench_s);
      } catch (const std::invalid_argument&) {
        arbiter.count_unreadable();
      }
    }
  }

  udp::socket socket;
  int start_slot;
  LightRig& rig;
  SourceArbiter arbiter;
  sacn::Bytes datagram;
};

LightReceiver::LightReceiver(asio::io_context& context, const SacnSettings& settings, std::uint16_t port, LightRig& rig)
    : state_(std::make_unique<State>(context, settings, port, rig)) {}

LightReceiver::~LightReceiver() = default;

void LightReceiver::begin_cycle(double bench_s) {
  State& state = *state_;
  // The lamp moves to its old place until now, to the new one from now on.
  state.rig.advance(bench_s);
  state.drain(bench_s);
  state.arbiter.advance(bench_s);
  if (!state.arbiter.is_controlled()) return state.rig.switch_off();
  LightValues values{};
  sacn::load_values(state.arbiter.slots(), state.start_slot, values);
  state.rig.command(values);
}

std::uint16_t LightReceiver::port() const {
  return state_->socket.local_endpoint().port();
}

std::string LightReceiver::address() const {
  const auto local = state_->socket.local_endpoint();
  return fmt::format("{}:{}", local.address().to_string(), local.port());
}

const SourceCounts& LightReceiver::counts() const {
  return state_->arbiter.counts();
}

}  // namespace vbar::tron::bench
