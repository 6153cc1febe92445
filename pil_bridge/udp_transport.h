#pragma once
// Frames over UDP, one a datagram, to and from one fixed address.

#include <cstdint>
#include <memory>
#include <string>

#include "pil_bridge/file_descriptor.h"
#include "pil_bridge/transport.h"

namespace vbar::pil {

/// Datagrams that come from any other address than `peer` are ignored and counted. `local_port` 0: any free one. The
/// socket is bound to the loopback interface when the peer is there, else to all. Throws LinkError.
std::unique_ptr<FrameTransport> make_udp_transport(const std::string& peer_address, std::uint16_t peer_port,
                                                   std::uint16_t local_port = 0);

/// Like the above, on a socket that is bound already.
std::unique_ptr<FrameTransport> make_udp_transport(FileDescriptor bound_socket, const std::string& peer_address,
                                                   std::uint16_t peer_port);

struct BoundUdpSocket {
  FileDescriptor socket;
  std::uint16_t port = 0;
};
/// A UDP socket on a free port of 127.0.0.1.
BoundUdpSocket bind_udp_loopback();

}  // namespace vbar::pil
