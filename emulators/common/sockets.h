#pragma once
// Asynchronous sockets of the servers. Objects are shared with the handlers that are under way; close() ends them, and
// no callback is called afterwards.

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>

#include "hil_drivers/wire/bytes.h"

namespace vbar::emulators {

/// TCP connection that a client has opened.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  using Receive = std::function<void(Connection& connection, std::span<const std::uint8_t> bytes)>;

  explicit Connection(boost::asio::ip::tcp::socket socket) : socket_(std::move(socket)) {}

  void start(Receive receive);
  /// Sends the bytes; without effect after close(), or to a client that does not read.
  void send(wire::Bytes bytes);
  void send(std::string_view text) { send(wire::Bytes(text.begin(), text.end())); }
  void close();
  [[nodiscard]] bool is_open() const { return socket_.is_open(); }

 private:
  void read();
  void write();

  boost::asio::ip::tcp::socket socket_;
  Receive receive_;
  std::array<std::uint8_t, 4096> buffer_{};
  std::deque<wire::Bytes> outgoing_;
  std::size_t outgoing_bytes_ = 0;
};

/// A TCP port that accepts connections.
class Listener : public std::enable_shared_from_this<Listener> {
 public:
  /// Makes the receiver of a new connection's bytes; empty: the connection is closed at once.
  using Accept = std::function<Connection::Receive()>;

  /// Opens the port. Throws std::runtime_error if it is not available.
  Listener(boost::asio::io_context& context, std::uint16_t port,
           const boost::asio::ip::address_v4& address = boost::asio::ip::address_v4::loopback());

  void start(Accept accept);
  void close_connections();
  void close();
  [[nodiscard]] std::uint16_t port() const;

 private:
  void accept_next();

  boost::asio::ip::tcp::acceptor acceptor_;
  Accept accept_;
  std::vector<std::weak_ptr<Connection>> connections_;
};

/// A UDP port.
class DatagramPort : public std::enable_shared_from_this<DatagramPort> {
 public:
  using Endpoint = boost::asio::ip::udp::endpoint;
  using Receive = std::function<void(std::span<const std::uint8_t> datagram, const Endpoint& sender)>;

  /// Opens the port. Throws std::runtime_error if it is not available.
  DatagramPort(boost::asio::io_context& context, std::uint16_t port);

  void start(Receive receive);
  /// Handles the datagrams that have arrived by now.
  void drain();
  /// Sends a datagram. One that the system does not accept is lost.
  void send(std::span<const std::uint8_t> datagram, const Endpoint& receiver);
  void close();
  [[nodiscard]] std::uint16_t port() const;

 private:
  void read();

  boost::asio::ip::udp::socket socket_;
  Receive receive_;
  std::array<std::uint8_t, 2048> buffer_{};
};

/// Opens a TCP and a UDP port with the same number, any free one if `port` is 0. Throws std::runtime_error.
std::pair<std::shared_ptr<Listener>, std::shared_ptr<DatagramPort>> bind_both(boost::asio::io_context& context,
                                                                              std::uint16_t port);

}  // namespace vbar::emulators
