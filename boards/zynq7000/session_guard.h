#pragma once
// Senders of this board, and the session guard that admits one of them (boards/common/session_guard.h).

#include <cstdint>

#include "boards/common/session_guard.h"
#include "boards/zynq7000/udp_endpoint.h"

namespace vbar::boards::zynq7000 {

enum class Interface : std::uint8_t { kSerial, kEthernet };

/// Sender, as far as its interface distinguishes senders. The serial line has one sender; on Ethernet a sender is an
/// address and a port.
struct Sender {
  Interface interface = Interface::kSerial;
  UdpPeer peer;  ///< kEthernet

  friend bool operator==(const Sender& a, const Sender& b) {
    return a.interface == b.interface &&
           (a.interface == Interface::kSerial || (a.peer.address == b.peer.address && a.peer.port == b.peer.port));
  }
};

using SessionGuard = boards::SessionGuard<Sender>;

}  // namespace vbar::boards::zynq7000
