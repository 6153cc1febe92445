#pragma once
// Who may speak to the flight software. A board has two interfaces, and anybody may send to them; a session has one
// peer.
//
// The first sender of a valid kHello becomes the peer. Frames of anybody else are refused and counted until the session
// ends: with its kGoodbye, or, so that a host that died does not lock a board, once the peer has been silent for a
// while and somebody else says hello.

#include <cstdint>
#include <span>

#include "boards/zynq7000/udp_endpoint.h"

namespace vbar::boards::zynq7000 {

enum class Interface : std::uint8_t { kSerial, kEthernet };

/// A sender, as far as its interface can tell senders apart. Everything on the serial line is one sender; on Ethernet a
/// sender is an address and a port.
struct Sender {
  Interface interface = Interface::kSerial;
  UdpPeer peer;  ///< kEthernet

  friend bool operator==(const Sender& a, const Sender& b) {
    return a.interface == b.interface &&
           (a.interface == Interface::kSerial || (a.peer.address == b.peer.address && a.peer.port == b.peer.port));
  }
};

class SessionGuard {
 public:
  /// `silence` in the unit of the times given to `admits`: how long a peer may say nothing before another may take
  /// over.
  explicit SessionGuard(std::uint64_t silence) : silence_(silence) {}

  /// True if the frame, received at `now`, is for the flight software. A kHello that is admitted makes its sender the
  /// peer.
  bool admits(const Sender& sender, std::span<const std::uint8_t> frame, std::uint64_t now);

  /// The peer said goodbye.
  void end_session() { has_peer_ = false; }

  [[nodiscard]] bool has_peer() const { return has_peer_; }
  /// Where answers go; meaningful while has_peer().
  [[nodiscard]] const Sender& peer() const { return peer_; }

 private:
  std::uint64_t silence_;
  std::uint64_t last_heard_ = 0;
  Sender peer_;
  bool has_peer_ = false;
};

}  // namespace vbar::boards::zynq7000
