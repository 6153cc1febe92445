#include "host_sim/io/udp_socket.h"

#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>

namespace vbar::io {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

[[noreturn]] void fail(const std::string& what, const error_code& error) {
  throw ChannelError(what + ": " + error.message());
}

/// A window of the largest frames of the board's link each way, several times over.
constexpr int kSocketBufferBytes = 512 * 1024;

udp::endpoint parse_peer(const std::string& address, std::uint16_t port) {
  error_code error;
  const auto parsed = asio::ip::make_address_v4(address, error);
  if (error) throw ChannelError("'" + address + "' is not an IPv4 address");
  return {parsed, port};
}

}  // namespace

struct UdpSocket::State {
  State(const std::string& peer_address, std::uint16_t peer_port, std::size_t max_bytes)
      : socket(context), peer(parse_peer(peer_address, peer_port)), datagram(max_bytes + 1) {}

  void set_buffers() {
    error_code ignored;  // the system's default is a working size, too
    socket.set_option(asio::socket_base::receive_buffer_size(kSocketBufferBytes), ignored);
    socket.set_option(asio::socket_base::send_buffer_size(kSocketBufferBytes), ignored);
  }

  void start_receiving() {
    receiving = true;
    socket.async_receive_from(asio::buffer(datagram), sender, [this](const error_code& failure, std::size_t count) {
      receiving = false;
      error = failure;
      size = failure ? 0 : count;
    });
  }

  asio::io_context context;
  udp::socket socket;
  udp::endpoint peer;
  udp::endpoint sender;
  std::vector<std::uint8_t> datagram;  ///< one byte more than accepted, so that a longer one is detected
  std::size_t size = 0;
  error_code error;
  bool receiving = false;
  std::uint64_t foreign = 0;
};

UdpSocket::UdpSocket(const std::string& peer_address, std::uint16_t peer_port, std::uint16_t local_port,
                     std::size_t max_bytes)
    : state_(std::make_unique<State>(peer_address, peer_port, max_bytes)) {
  error_code error;
  state_->socket.open(udp::v4(), error);
  const bool peer_is_here = state_->peer.address().is_loopback();
  const auto local = peer_is_here ? asio::ip::address_v4::loopback() : asio::ip::address_v4::any();
  if (!error) state_->socket.bind(udp::endpoint(local, local_port), error);
  if (error) fail("udp port " + std::to_string(local_port), error);
  state_->set_buffers();
}

UdpSocket::UdpSocket(FileDescriptor bound_socket, const std::string& peer_address, std::uint16_t peer_port,
                     std::size_t max_bytes)
    : state_(std::make_unique<State>(peer_address, peer_port, max_bytes)) {
  error_code error;
  state_->socket.assign(udp::v4(), bound_socket.get(), error);
  if (error) fail("udp socket", error);
  (void)bound_socket.release();
  state_->set_buffers();
}

UdpSocket::~UdpSocket() = default;

void UdpSocket::send(std::span<const std::uint8_t> bytes) {
  error_code error;
  state_->socket.send_to(asio::buffer(bytes.data(), bytes.size()), state_->peer, 0, error);
  // The peer does not exist yet, or there is no buffer.
  if (error && error != asio::error::connection_refused && error != asio::error::no_buffer_space)
    fail(description(), error);
}

std::optional<std::span<const std::uint8_t>> UdpSocket::receive(Clock::time_point deadline) {
  State& state = *state_;
  // A flood of foreign datagrams does not prolong the wait.
  for (bool overdue = false; !overdue;) {
    overdue = Clock::now() >= deadline;
    if (!state.receiving) state.start_receiving();
    if (state.context.stopped()) state.context.restart();
    while (state.receiving && (state.context.run_one_until(deadline) != 0 || state.context.poll_one() != 0)) {
    }
    if (state.receiving) return std::nullopt;
    if (state.error == asio::error::connection_refused) continue;
    if (state.error) fail(description(), state.error);
    if (state.sender == state.peer) return std::span<const std::uint8_t>(state.datagram).first(state.size);
    ++state.foreign;
  }
  return std::nullopt;
}

std::uint64_t UdpSocket::foreign_datagrams() const {
  return state_->foreign;
}

std::string UdpSocket::description() const {
  return "udp " + state_->peer.address().to_string() + ":" + std::to_string(state_->peer.port());
}

BoundUdpSocket bind_udp_loopback() {
  asio::io_context context;
  udp::socket socket(context);
  error_code error;
  socket.open(udp::v4(), error);
  if (!error) socket.bind(udp::endpoint(asio::ip::address_v4::loopback(), 0), error);
  std::uint16_t port = 0;
  if (!error) port = socket.local_endpoint(error).port();
  if (error) fail("a free udp port on 127.0.0.1", error);
  return {FileDescriptor(socket.release()), port};
}

}  // namespace vbar::io
