#include "pil_bridge/udp_transport.h"

#include <array>
#include <optional>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>

#include "fsw/link/frame.h"

namespace vbar::pil {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

[[noreturn]] void fail(const std::string& what, const error_code& error) {
  throw LinkError(what + ": " + error.message());
}

/// A window of the largest frames each way, several times over.
constexpr int kSocketBufferBytes = 512 * 1024;

class UdpTransport final : public FrameTransport {
 public:
  UdpTransport(std::unique_ptr<asio::io_context> context, udp::socket socket, const udp::endpoint& peer)
      : context_(std::move(context)), socket_(std::move(socket)), peer_(peer) {
    error_code ignored;  // the system's default is a working size, too
    socket_.set_option(asio::socket_base::receive_buffer_size(kSocketBufferBytes), ignored);
    socket_.set_option(asio::socket_base::send_buffer_size(kSocketBufferBytes), ignored);
  }

  void send(std::span<const std::uint8_t> frame) override {
    error_code error;
    socket_.send_to(asio::buffer(frame.data(), frame.size()), peer_, 0, error);
    // A peer that is not there yet, or no buffer: the datagram is lost, as datagrams may be.
    if (error && error != asio::error::connection_refused && error != asio::error::no_buffer_space) {
      fail(description(), error);
    }
    counters_.bytes_sent += frame.size();
  }

  std::span<const std::uint8_t> receive(Clock::time_point deadline) override {
    // A flood of datagrams that are no frames does not prolong the wait.
    for (bool overdue = false; !overdue;) {
      overdue = Clock::now() >= deadline;
      const auto size = next_datagram(deadline);
      if (!size) return {};
      if (sender_ != peer_) {
        ++counters_.strangers_ignored;
        continue;
      }
      counters_.bytes_received += *size;
      if (*size == 0 || *size > fsw::link::kMaxFrameBytes) {
        ++counters_.frames_rejected;
        continue;
      }
      return std::span(datagram_).first(*size);
    }
    return {};
  }

  [[nodiscard]] TransportCounters counters() const override { return counters_; }

  [[nodiscard]] std::string description() const override {
    return "udp " + peer_.address().to_string() + ":" + std::to_string(peer_.port());
  }

 private:
  /// Size of the datagram now in `datagram_`; none if nothing came by `deadline`.
  std::optional<std::size_t> next_datagram(Clock::time_point deadline) {
    if (!receiving_) start_receiving();
    if (context_->stopped()) context_->restart();
    while (receiving_ && (context_->run_one_until(deadline) != 0 || context_->poll_one() != 0)) {
    }
    if (receiving_) return std::nullopt;
    if (error_ && error_ != asio::error::connection_refused) fail(description(), error_);
    return size_;
  }

  void start_receiving() {
    receiving_ = true;
    socket_.async_receive_from(asio::buffer(datagram_), sender_, [this](const error_code& error, std::size_t size) {
      receiving_ = false;
      error_ = error;
      size_ = error ? 0 : size;
    });
  }

  std::unique_ptr<asio::io_context> context_;
  udp::socket socket_;
  udp::endpoint peer_;
  udp::endpoint sender_;
  // One byte more than a frame may have, so that a longer datagram is seen to be longer.
  std::array<std::uint8_t, fsw::link::kMaxFrameBytes + 1> datagram_{};
  std::size_t size_ = 0;
  error_code error_;
  bool receiving_ = false;
  TransportCounters counters_;
};

udp::endpoint parse_peer(const std::string& address, std::uint16_t port) {
  error_code error;
  const auto parsed = asio::ip::make_address_v4(address, error);
  if (error) throw LinkError("'" + address + "' is not an IPv4 address");
  return {parsed, port};
}

}  // namespace

std::unique_ptr<FrameTransport> make_udp_transport(const std::string& peer_address, std::uint16_t peer_port,
                                                   std::uint16_t local_port) {
  const udp::endpoint peer = parse_peer(peer_address, peer_port);
  auto context = std::make_unique<asio::io_context>();
  udp::socket socket(*context);
  error_code error;
  socket.open(udp::v4(), error);
  const auto local = peer.address().is_loopback() ? asio::ip::address_v4::loopback() : asio::ip::address_v4::any();
  if (!error) socket.bind(udp::endpoint(local, local_port), error);
  if (error) fail("udp port " + std::to_string(local_port), error);
  return std::make_unique<UdpTransport>(std::move(context), std::move(socket), peer);
}

std::unique_ptr<FrameTransport> make_udp_transport(FileDescriptor bound_socket, const std::string& peer_address,
                                                   std::uint16_t peer_port) {
  const udp::endpoint peer = parse_peer(peer_address, peer_port);
  auto context = std::make_unique<asio::io_context>();
  udp::socket socket(*context);
  error_code error;
  socket.assign(udp::v4(), bound_socket.get(), error);
  if (error) fail("udp socket", error);
  (void)bound_socket.release();
  return std::make_unique<UdpTransport>(std::move(context), std::move(socket), peer);
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

}  // namespace vbar::pil
