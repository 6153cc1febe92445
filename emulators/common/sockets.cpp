#include "emulators/common/sockets.h"

#include <algorithm>
#include <stdexcept>

#include <boost/asio/write.hpp>
#include <fmt/format.h>

namespace vbar::emulators {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using asio::ip::udp;
using boost::system::error_code;

/// A client that does not read its answers is cut off rather than kept in memory.
constexpr std::size_t kMaxOutgoingBytes = std::size_t{1} << 20;
constexpr int kReceiveBufferBytes = 512 * 1024;

void require(const error_code& error, std::string_view kind, const asio::ip::address_v4& address, std::uint16_t port) {
  if (error)
    throw std::runtime_error(
        fmt::format("{} port {} of {} is not available: {}", kind, port, address.to_string(), error.message()));
}

}  // namespace

void Connection::start(Receive receive) {
  receive_ = std::move(receive);
  read();
}

void Connection::read() {
  socket_.async_read_some(asio::buffer(buffer_), [self = shared_from_this()](const error_code& error, std::size_t n) {
    if (error || !self->receive_) return self->close();
    // The callback may close the connection, which clears receive_.
    const Receive receive = self->receive_;
    receive(*self, std::span<const std::uint8_t>(self->buffer_).first(n));
    if (self->is_open()) self->read();
  });
}

void Connection::send(wire::Bytes bytes) {
  if (!is_open() || bytes.empty()) return;
  outgoing_bytes_ += bytes.size();
  if (outgoing_bytes_ > kMaxOutgoingBytes) return close();
  outgoing_.push_back(std::move(bytes));
  if (outgoing_.size() == 1) write();
}

void Connection::write() {
  asio::async_write(socket_, asio::buffer(outgoing_.front()),
                    [self = shared_from_this()](const error_code& error, std::size_t n) {
                      if (error || !self->is_open()) return self->close();
                      self->outgoing_bytes_ -= n;
                      self->outgoing_.pop_front();
                      if (!self->outgoing_.empty()) self->write();
                    });
}

void Connection::close() {
  receive_ = nullptr;
  error_code ignored;
  socket_.close(ignored);
}

Listener::Listener(asio::io_context& context, std::uint16_t port, const asio::ip::address_v4& address)
    : acceptor_(context) {
  error_code error;
  acceptor_.open(tcp::v4(), error);
  if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor_.bind(tcp::endpoint(address, port), error);
  if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
  require(error, "TCP", address, port);
}

void Listener::start(Accept accept) {
  accept_ = std::move(accept);
  accept_next();
}

void Listener::accept_next() {
  acceptor_.async_accept([self = shared_from_this()](const error_code& error, tcp::socket socket) {
    if (!self->accept_ || error == asio::error::operation_aborted) return;
    if (!error) {
      error_code ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      auto connection = std::make_shared<Connection>(std::move(socket));
      if (Connection::Receive receive = self->accept_()) {
        std::erase_if(self->connections_, [](const auto& other) { return other.expired(); });
        self->connections_.push_back(connection);
        connection->start(std::move(receive));
      }
    }
    self->accept_next();
  });
}

void Listener::close_connections() {
  for (const auto& weak : connections_)
    if (const auto connection = weak.lock()) connection->close();
  connections_.clear();
}

void Listener::close() {
  accept_ = nullptr;
  close_connections();
  error_code ignored;
  acceptor_.close(ignored);
}

std::uint16_t Listener::port() const {
  return acceptor_.local_endpoint().port();
}

DatagramPort::DatagramPort(asio::io_context& context, std::uint16_t port) : socket_(context) {
  error_code error;
  socket_.open(udp::v4(), error);
  if (!error) socket_.bind(udp::endpoint(asio::ip::address_v4::loopback(), port), error);
  if (!error) socket_.non_blocking(true, error);
  require(error, "UDP", asio::ip::address_v4::loopback(), port);
  error_code ignored;  // the system's default is a working size, too
  socket_.set_option(asio::socket_base::receive_buffer_size(kReceiveBufferBytes), ignored);
}

void DatagramPort::start(Receive receive) {
  receive_ = std::move(receive);
  read();
}

void DatagramPort::read() {
  // Only readiness is asynchronous: drain() may have read in the meantime.
  socket_.async_wait(udp::socket::wait_read, [self = shared_from_this()](const error_code& error) {
    if (!self->receive_ || error == asio::error::operation_aborted) return;
    self->drain();
    if (self->receive_) self->read();
  });
}

void DatagramPort::drain() {
  // Limit of a call, so that a flood does not hold the event loop for long.
  constexpr int kAtATime = 256;
  for (int count = 0; count < kAtATime && receive_; ++count) {
    Endpoint sender;
    error_code error;
    const std::size_t n = socket_.receive_from(asio::buffer(buffer_), sender, 0, error);
    if (error == asio::error::would_block) return;
    if (error) continue;  // a peer that has gone reports itself here
    const Receive receive = receive_;
    receive(std::span<const std::uint8_t>(buffer_).first(n), sender);
  }
}

void DatagramPort::send(std::span<const std::uint8_t> datagram, const Endpoint& receiver) {
  error_code ignored;
  socket_.send_to(asio::buffer(datagram.data(), datagram.size()), receiver, 0, ignored);
}

void DatagramPort::close() {
  receive_ = nullptr;
  error_code ignored;
  socket_.close(ignored);
}

std::uint16_t DatagramPort::port() const {
  return socket_.local_endpoint().port();
}

std::pair<std::shared_ptr<Listener>, std::shared_ptr<DatagramPort>> bind_both(asio::io_context& context,
                                                                              std::uint16_t port) {
  constexpr int kAttempts = 32;
  for (int attempt = 1;; ++attempt) {
    auto listener = std::make_shared<Listener>(context, port);
    try {
      return {listener, std::make_shared<DatagramPort>(context, listener->port())};
    } catch (const std::runtime_error&) {
      // Another program has the UDP port of this number.
      if (port != 0 || attempt == kAttempts) throw;
    }
  }
}

}  // namespace vbar::emulators
