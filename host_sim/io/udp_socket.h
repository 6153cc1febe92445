#pragma once
// Datagrams to and from one fixed peer.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "host_sim/io/byte_channel.h"
#include "host_sim/io/file_descriptor.h"

namespace vbar::io {

class UdpSocket {
 public:
  /// `local_port` 0: any free one. The socket is bound to the loopback interface if the peer is there, otherwise to all
  /// interfaces. Datagrams of more than `max_bytes` are delivered with one byte more than that. Throws ChannelError.
  UdpSocket(const std::string& peer_address, std::uint16_t peer_port, std::uint16_t local_port, std::size_t max_bytes);
  /// Uses a socket that is bound already.
  UdpSocket(FileDescriptor bound_socket, const std::string& peer_address, std::uint16_t peer_port,
            std::size_t max_bytes);
  ~UdpSocket();
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  /// Sends one datagram; one that the system does not accept now or that is not received is lost, as for UDP.
  /// Throws ChannelError.
  void send(std::span<const std::uint8_t> bytes);

  /// The next datagram of the peer, possibly an empty one; nothing if none arrived by `deadline`. Valid until the next
  /// call. Throws ChannelError.
  std::optional<std::span<const std::uint8_t>> receive(Clock::time_point deadline);

  /// Datagrams received from any other address, which are discarded.
  [[nodiscard]] std::uint64_t foreign_datagrams() const;
  [[nodiscard]] std::string description() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

struct BoundUdpSocket {
  FileDescriptor socket;
  std::uint16_t port = 0;
};
/// A UDP socket on a free port of 127.0.0.1.
BoundUdpSocket bind_udp_loopback();

}  // namespace vbar::io
