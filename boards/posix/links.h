#pragma once
// Frame links of a flight computer under a POSIX system: a byte stream (serial device, pseudo-terminal, socket) and
// UDP. Both serve a FlightExecutive until the run is over or the host is gone.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <netinet/in.h>

#include "boards/common/flight_executive.h"
#include "boards/common/session_guard.h"
#include "boards/posix/receiver_line.h"
#include "fsw/link/cobs.h"

namespace vbar::boards::posix {

enum class LinkEnd : std::uint8_t {
  kGoodbye,   ///< the host ended the run
  kPeerGone,  ///< the other end of the stream was closed
  kFailed,    ///< a read or write failed; errno gives the reason
};

class StreamLink {
 public:
  /// `fd` stays the caller's; a terminal must be in raw mode.
  explicit StreamLink(int fd) : fd_(fd) {}

  /// Implements `Platform::send`, with a StreamLink as context.
  static void send(void* context, std::span<const std::uint8_t> frame);

  /// Feeds `executive` until the link ends; also with the bytes of `receiver`, if it is not null.
  LinkEnd serve(FlightExecutive& executive, const ReceiverLine* receiver = nullptr);

 private:
  int fd_;
  bool broken_ = false;  ///< a write failed: the host is gone
  fsw::link::CobsDecoder decoder_;
  std::array<std::uint8_t, 4096> received_{};
  std::array<std::uint8_t, fsw::link::kMaxCobsFrameBytes> coded_{};
};

/// Address and port of a datagram's sender.
struct DatagramSender {
  sockaddr_in address{};

  friend bool operator==(const DatagramSender& a, const DatagramSender& b) {
    return a.address.sin_addr.s_addr == b.address.sin_addr.s_addr && a.address.sin_port == b.address.sin_port;
  }
};

class DatagramLink {
 public:
  static constexpr std::uint64_t kSilence_ms = 5'000;  ///< as on the Zynq

  /// `fd`, a bound UDP socket, stays the caller's. Serves the first sender of a valid kHello, and another only once
  /// that one has been silent.
  explicit DatagramLink(int fd, std::uint64_t silence_ms = kSilence_ms) : fd_(fd), guard_(silence_ms) {}
  /// Serves `peer` alone.
  DatagramLink(int fd, const sockaddr_in& peer) : fd_(fd), fixed_peer_{peer}, peer_is_fixed_(true) {}

  /// Implements `Platform::send`, with a DatagramLink as context.
  static void send(void* context, std::span<const std::uint8_t> frame);

  /// Serves as StreamLink::serve does. Datagrams of other senders are counted as rejected.
  LinkEnd serve(FlightExecutive& executive, const ReceiverLine* receiver = nullptr);

 private:
  [[nodiscard]] bool admits(const DatagramSender& sender, std::span<const std::uint8_t> datagram);

  int fd_;
  SessionGuard<DatagramSender> guard_{kSilence_ms};
  DatagramSender fixed_peer_;
  bool peer_is_fixed_ = false;
  // One byte more than a frame may have, so that a longer datagram is detected.
  std::array<std::uint8_t, fsw::link::kMaxFrameBytes + 1> received_{};
};

}  // namespace vbar::boards::posix
