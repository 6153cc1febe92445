#pragma once

#include <stdexcept>

#include "fsw/packets/messages.h"
#include "host_sim/twins/packet_source.h"

namespace vbar::external {

/// Returns the packet of a message. Throws std::runtime_error for a number that is not finite.
template <class Message>
[[nodiscard]] twins::Packet packet_of(const fsw::packets::PacketHeader& header, const Message& message) {
  twins::Packet packet(fsw::packets::kMaxPacketBytes);
  const auto size = fsw::packets::encode(header, message, packet);
  if (!size.ok()) throw std::runtime_error("a number that is not finite");
  packet.resize(size.value());
  return packet;
}

}  // namespace vbar::external
