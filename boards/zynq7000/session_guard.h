#pragma once
// Access control of the flight software. A board has two interfaces with any number of senders; a session has one
// peer.
//
// The first sender of a valid kHello becomes the peer. Frames of other senders are refused and counted until its end:
// with the goodbye of the peer, or, so that a lost host does not block the board, once the peer has been silent for a
// time limit and another sender sends a hello.

#include <cstdint>
#include <span>

#include "boards/zynq7000/udp_endpoint.h"

namespace vbar::boards::zynq7000 {

enum class Interface : std::uint8_t { kSerial, kEthernet };

/// A sender, as far as its interface distinguishes senders. The serial line has one sender; on Ethernet a
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
  /// `silence` in the unit of the times given to `admits`: time without a frame of the peer after which another sender
  /// may take over.
  explicit SessionGuard(std::uint64_t silence) : silence_(silence) {}

  /// True if the frame, received at `now`, is for the flight software. A kHello that is admitted makes its sender the
  /// peer.
  bool admits(const Sender& sender, std::span<const std::uint8_t> frame, std::uint64_t now);

  /// The goodbye of the peer.
  void end_session() { has_peer_ = false; }

  [[nodiscard]] bool has_peer() const { return has_peer_; }
  /// Destination of answers; valid while has_peer().
  [[nodiscard]] const Sender& peer() const { return peer_; }

 private:
  std::uint64_t silence_;
  std::uint64_t last_heard_ = 0;
  Sender peer_;
  bool has_peer_ = false;
};

}  // namespace vbar::boards::zynq7000
