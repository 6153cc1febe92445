#pragma once
// Frames over UDP, one per datagram, to and from one fixed address.

#include <cstdint>
#include <memory>
#include <string>

#include "host_sim/io/file_descriptor.h"
#include "pil_bridge/transport.h"

namespace vbar::pil {

/// Datagrams that come from any other address than `peer` are ignored and counted (io::UdpSocket). Throws LinkError.
std::unique_ptr<FrameTransport> make_udp_transport(const std::string& peer_address, std::uint16_t peer_port,
                                                   std::uint16_t local_port = 0);

/// Makes the same on a socket that is bound already.
std::unique_ptr<FrameTransport> make_udp_transport(io::FileDescriptor bound_socket, const std::string& peer_address,
                                                   std::uint16_t peer_port);

}  // namespace vbar::pil
