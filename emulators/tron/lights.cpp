#include "emulators/tron/lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/udp.hpp>
#include <fmt/format.h>

#include "hil_drivers/tron/protocols/sacn.h"
#include "host_sim/engine/random_stream.h"

namespace vbar::tron::bench {

namespace {

/// E1.31 6.7.2: a packet is out of sequence if it is up to 19 behind the last one, or the last one again.
bool is_out_of_sequence(std::uint8_t sequence, std::uint8_t last) {
  const auto step = static_cast<std::int8_t>(static_cast<std::uint8_t>(sequence - last));
  return step <= 0 && step > -20;
}

}  // namespace

bool SourceArbiter::is_for_us(const sacn::DataPacket& packet) {
  if (packet.universe != universe_) {
    ++counts_.of_other_universes;
    return false;
  }
  if (packet.is_preview) {
    ++counts_.previews;
    return false;
  }
  if (packet.start_code != 0 && !packet.is_terminated) {
    ++counts_.of_other_start_codes;
    return false;
  }
  return true;
}

void SourceArbiter::accept(const sacn::DataPacket& packet, double bench_s) {
  if (!is_for_us(packet)) return;
  auto source = std::ranges::find(sources_, packet.cid, &Source::cid);
  if (source != sources_.end() && is_out_of_sequence(packet.sequence, source->sequence)) {
    ++counts_.out_of_sequence;
    return;
  }
  if (packet.is_terminated) {
    if (source == sources_.end()) return;  // further packets of a source that has ended
    ++counts_.terminations;
    sources_.erase(source);
    return;
  }
  if (source == sources_.end()) {
    if (sources_.size() == kMaxSources) {
      ++counts_.refused_sources;
      return;
    }
    source = sources_.insert(source, Source{packet.cid});
  }
  ++counts_.accepted;
  source->priority = packet.priority;
  source->sequence = packet.sequence;
  source->heard_s = bench_s;
  source->slots = packet.slots;
}

void SourceArbiter::advance(double bench_s) {
  counts_.losses +=
      std::erase_if(sources_, [&](const Source& source) { return bench_s - source.heard_s > kLossSeconds; });
}

std::span<const std::uint8_t> SourceArbiter::slots() const {
  const auto controlling = std::ranges::max_element(sources_, {}, &Source::priority);  // the first of several
  if (controlling == sources_.end()) return {};
  return controlling->slots;
}

namespace {

constexpr double kFullValue = std::numeric_limits<std::uint16_t>::max();
constexpr double kMinGamma = 0.1;

}  // namespace

double LightRig::Response::light(std::uint16_t value) const {
  return value == 0 ? 0.0 : gain * std::pow(value / kFullValue, gamma);
}

LightRig::LightRig(const Lamp& lamp, const LightErrorSizes& sizes, std::uint64_t seed)
    : lamp_(lamp),
      azimuth_rad_(0.5 * (lamp.azimuth_low_rad + lamp.azimuth_high_rad)),
      wanted_azimuth_rad_(azimuth_rad_) {
  for (std::size_t k = 0; k < responses_.size(); ++k) {
    engine::RandomStream random(seed, "tron/lights/" + (k == 0 ? std::string("lamp") : "box " + std::to_string(k)));
    responses_[k].gamma = std::max(kMinGamma, sizes.gamma + sizes.gamma_spread * random.normal());
    responses_[k].gain = std::max(0.0, 1.0 + sizes.gain_spread * random.normal());
  }
}

void LightRig::command(const LightValues& values) {
  values_ = values;
  const double share = values[kPlace] / kFullValue;
  wanted_azimuth_rad_ = lamp_.azimuth_low_rad + share * (lamp_.azimuth_high_rad - lamp_.azimuth_low_rad);
}

void LightRig::switch_off() {
  values_ = {};
  wanted_azimuth_rad_ = azimuth_rad_;
}

void LightRig::advance(double bench_s) {
  const double way = lamp_.speed_rad_s * std::max(0.0, bench_s - time_s_);
  time_s_ = std::max(time_s_, bench_s);
  azimuth_rad_ += std::clamp(wanted_azimuth_rad_ - azimuth_rad_, -way, way);
}

TrueLights LightRig::lights() const {
  TrueLights lights;
  lights.lamp_power = is_lamp_out_ ? 0.0 : responses_[0].light(values_[kLamp]);
  lights.lamp_azimuth_rad = azimuth_rad_;
  for (std::size_t k = 0; k < kBoxes; ++k)
    lights.box_power[k] = is_box_out_[k] ? 0.0 : responses_[1 + k].light(values_[kFirstBox + k]);
  return lights;
}

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
