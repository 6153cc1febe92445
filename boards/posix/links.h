#pragma once
// The frame links of a flight computer under a POSIX system: a byte stream (serial device, pseudo-terminal, socket) and
// UDP. Both serve a FlightExecutive until the run is over or the host is gone.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <netinet/in.h>

#include "boards/common/flight_executive.h"
#include "fsw/link/cobs.h"

namespace vbar::boards::posix {

enum class LinkEnd : std::uint8_t {
  kGoodbye,   ///< the host ended the run
  kPeerGone,  ///< the other end of the stream was closed
  kFailed,    ///< the system refused to read or write; errno says why
};

class StreamLink {
 public:
  /// `fd` stays the caller's; a terminal must be in raw mode.
  explicit StreamLink(int fd) : fd_(fd) {}

  /// `Platform::send`, with a StreamLink as context.
  static void send(void* context, std::span<const std::uint8_t> frame);

  /// Feeds `executive` until the link ends.
  LinkEnd serve(FlightExecutive& executive);

 private:
  int fd_;
  bool broken_ = false;  ///< a write failed: the host is gone
  fsw::link::CobsDecoder decoder_;
  std::array<std::uint8_t, 4096> received_{};
  std::array<std::uint8_t, fsw::link::kMaxCobsFrameBytes> coded_{};
};

class DatagramLink {
 public:
  /// `fd`, a bound UDP socket, stays the caller's. Serves whoever sends a valid kHello; everybody else is a stranger.
  explicit DatagramLink(int fd) : fd_(fd) {}
  /// Serves `peer` alone.
  DatagramLink(int fd, const sockaddr_in& peer) : fd_(fd), peer_(peer), has_peer_(true), peer_is_fixed_(true) {}

  /// `Platform::send`, with a DatagramLink as context.
  static void send(void* context, std::span<const std::uint8_t> frame);

  /// Feeds `executive` until the link ends. Datagrams of strangers are ignored and counted.
  LinkEnd serve(FlightExecutive& executive);

 private:
  [[nodiscard]] bool accepts(const sockaddr_in& sender, std::span<const std::uint8_t> datagram);

  int fd_;
  sockaddr_in peer_{};
  bool has_peer_ = false;
  bool peer_is_fixed_ = false;
  // One byte more than a frame may have, so that a longer datagram is seen to be longer.
  std::array<std::uint8_t, fsw::link::kMaxFrameBytes + 1> received_{};
};

}  // namespace vbar::boards::posix
