#pragma once
// A byte stream to another device or process: a serial line or a stream socket. One thread; every call returns by a
// deadline.

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "host_sim/io/file_descriptor.h"

namespace vbar::io {

using Clock = std::chrono::steady_clock;

/// The channel does not work any more, or there is no answer on it.
class ChannelError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class ByteChannel {
 public:
  ByteChannel() = default;
  ByteChannel(const ByteChannel&) = delete;
  ByteChannel& operator=(const ByteChannel&) = delete;
  virtual ~ByteChannel() = default;

  /// Writes all of `bytes`. Throws ChannelError if the line is closed or does not accept them by `deadline`.
  virtual void write(std::span<const std::uint8_t> bytes, Clock::time_point deadline) = 0;

  /// The received bytes; empty if none arrived by `deadline`. Valid until the next call. Throws
  /// ChannelError.
  virtual std::span<const std::uint8_t> read(Clock::time_point deadline) = 0;

  [[nodiscard]] virtual std::string description() const = 0;
};

// The byte channels: a serial device, a pseudo-terminal, a Unix or TCP stream socket.

/// A serial device (or the slave end of a pseudo-terminal): raw, 8N1, no flow control, modem lines ignored.
std::unique_ptr<ByteChannel> open_serial(const std::string& device, unsigned baud);

/// Connects to a Unix stream socket; retries until `deadline` while no program listens.
std::unique_ptr<ByteChannel> connect_unix(const std::string& path, Clock::time_point deadline);

/// Connects to a TCP port, without Nagle's delay; retries until `deadline` while no program listens.
std::unique_ptr<ByteChannel> connect_tcp(const std::string& host, const std::string& port, Clock::time_point deadline);

/// Takes over a connected Unix stream socket.
std::unique_ptr<ByteChannel> adopt_socket(FileDescriptor socket, std::string description);

/// Takes over the master end of a pseudo-terminal.
std::unique_ptr<ByteChannel> adopt_pty(FileDescriptor master, std::string description);

/// A connected pair of Unix stream sockets: one for the host, one to hand to a child process.
std::pair<FileDescriptor, FileDescriptor> make_socket_pair();

struct Pty {
  FileDescriptor master;
  FileDescriptor slave;  ///< raw
  std::string slave_path;
};
/// A new pseudo-terminal in raw mode.
Pty make_pty();

/// Limits `channel`, in both directions, to the rate of a serial line of `bits_per_s` with 10 bits per byte (8N1): data
/// arrive at the other end when the last of their bytes would have.
std::unique_ptr<ByteChannel> paced(std::unique_ptr<ByteChannel> channel, double bits_per_s);

}  // namespace vbar::io
