#include "hil_drivers/tron/vicon/receiver.h"

#include <algorithm>
#include <stdexcept>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <fmt/format.h>
#include <poll.h>

#include "hil_drivers/tron/vicon/frame_history.h"

namespace vbar::tron::vicon {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

constexpr int kSocketBufferBytes = 4 * 1024 * 1024;  // room for seconds of frames
// A flood of datagrams does not hold the caller for ever.
constexpr int kMaxDatagramsOfDrain = 100000;

}  // namespace

struct Receiver::State {
  State(const ViconSettings& settings, const std::string& rotation, const std::string& address)
      : socket(context),
        history(settings.camera_object, settings.target_object, rotation.empty() ? settings.rotation : rotation),
        datagram(kMaxDatagramBytes + 1) {
    error_code error;
    const auto local = asio::ip::make_address_v4(address, error);
    if (!error) socket.open(udp::v4(), error);
    if (!error) socket.bind(udp::endpoint(local, settings.port), error);
    if (!error) socket.non_blocking(true, error);
    if (error)
      throw std::runtime_error(
          fmt::format("Vicon: UDP port {} of {} is not available: {}", settings.port, address, error.message()));
    error_code ignored;  // the system's default is a working size, too
    socket.set_option(asio::socket_base::receive_buffer_size(kSocketBufferBytes), ignored);
    port = socket.local_endpoint().port();
  }

  void drain() {
    udp::endpoint sender;
    for (int count = 0; count < kMaxDatagramsOfDrain; ++count) {
      error_code error;
      const std::size_t size = socket.receive_from(asio::buffer(datagram), sender, 0, error);
      if (error == asio::error::would_block) return;
      if (error) throw std::runtime_error(fmt::format("Vicon at UDP port {}: {}", port, error.message()));
      try {
        history.add(decode_block(ByteSpan(datagram).first(size)));
      } catch (const std::invalid_argument& refusal) {
        history.add_unreadable(refusal.what());
      }
    }
  }

  asio::io_context context;
  udp::socket socket;
  std::uint16_t port = 0;
  FrameHistory history;
  Bytes datagram;
};

Receiver::Receiver(const ViconSettings& settings, const std::string& rotation, const std::string& address)
    : state_(std::make_unique<State>(settings, rotation, address)) {}

Receiver::~Receiver() = default;

std::uint16_t Receiver::port() const {
  return state_->port;
}

void Receiver::clear() {
  state_->drain();
  state_->history.clear();
}

int Receiver::drain() {
  state_->drain();
  return state_->history.frames();
}

int Receiver::wait_for(int frames, std::chrono::milliseconds timeout) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + timeout;
  for (;;) {
    const int received = drain();
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    if (received >= frames || left <= 0) return received;
    pollfd waiting{state_->socket.native_handle(), POLLIN, 0};
    ::poll(&waiting, 1, static_cast<int>(std::min<long long>(left, 1000)));
  }
}

CaptureAverage Receiver::average(int frames, const Moved& moved) {
  return state_->history.average(frames, moved);
}

CaptureCounts Receiver::counts() const {
  return state_->history.counts();
}

std::string Receiver::description() const {
  return fmt::format("Vicon at UDP port {}", state_->port);
}

}  // namespace vbar::tron::vicon
