#pragma once
// Endpoints of frame links. Functions that return a file descriptor return -1 and leave errno on failure.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <netinet/in.h>

#include "boards/common/flight_executive.h"
#include "boards/common/session_guard.h"
#include "fsw/link/frame.h"

namespace vbar::boards::posix {

/// Opens a serial device: raw, 8N1, no flow control, modem lines ignored. An unknown baud rate: EINVAL.
int open_serial(const char* device, std::uint32_t baud);

/// Connects to a listening Unix stream socket.
int connect_unix(const char* path);

/// Opens a UDP socket bound to `address`.
int bind_udp(const sockaddr_in& address);

/// Puts `fd` into raw mode if it is a terminal. Returns false if that fails.
bool make_raw_if_terminal(int fd);

/// Converts "127.0.0.1:5000" to an address; false if `text` is not one.
bool parse_address(const char* text, sockaddr_in& address);

/// Reads a decimal number up to `limit`; false if `text` is not one.
bool parse_number(const char* text, std::uint32_t limit, std::uint32_t& number);

// Serial line on which a GNSS receiver is wired to a flight computer under a POSIX system.

class ReceiverLine {
 public:
  /// `device` is a serial device or pseudo-terminal, opened when a session requires it. Null: there is none.
  explicit ReceiverLine(const char* device) : device_(device) {}
  ~ReceiverLine() { close(); }
  ReceiverLine(const ReceiverLine&) = delete;
  ReceiverLine& operator=(const ReceiverLine&) = delete;

  /// Opens the device at this rate and discards earlier bytes. Returns false if it cannot be opened or the rate is
  /// unknown.
  bool open(std::uint32_t baud);
  void close();

  /// Moves received bytes to `out` without waiting; returns their number. A line that was hung up gives none and is
  /// opened again as soon as that is possible.
  std::size_t read(std::span<std::uint8_t> out);

  /// Descriptor to wait for bytes; -1 while the line is closed or hung up.
  [[nodiscard]] int fd() const { return fd_; }

 private:
  bool open_device();
  void hang_up();

  const char* device_;
  std::uint32_t baud_ = 0;  ///< 0: closed
  int fd_ = -1;
};

// Frame links of a flight computer under a POSIX system: a byte stream (serial device, pseudo-terminal, socket) and
// UDP. Both serve a FlightExecutive until the run is over or the host is gone.

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
