#pragma once
// The two layers under the step barrier: a byte channel (a serial line or a stream socket), and a frame transport,
// which is either COBS over such a channel or datagrams. One thread; calls return by a deadline.

#include <chrono>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

namespace vbar::pil {

using Clock = std::chrono::steady_clock;

/// The link to the flight computer does not work any more, or nobody answers on it.
class LinkError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class ByteChannel {
 public:
  ByteChannel() = default;
  ByteChannel(const ByteChannel&) = delete;
  ByteChannel& operator=(const ByteChannel&) = delete;
  virtual ~ByteChannel() = default;

  /// Writes all of `bytes`. Throws LinkError if the line is closed or does not take them by `deadline`.
  virtual void write(std::span<const std::uint8_t> bytes, Clock::time_point deadline) = 0;

  /// What has arrived: at least one byte, or none if nothing came by `deadline`. Valid until the next call. Throws
  /// LinkError.
  virtual std::span<const std::uint8_t> read(Clock::time_point deadline) = 0;

  [[nodiscard]] virtual std::string description() const = 0;
};

struct TransportCounters {
  std::uint64_t bytes_sent = 0;       ///< as coded for the wire
  std::uint64_t bytes_received = 0;   ///< likewise
  std::uint64_t frames_rejected = 0;  ///< dropped for breaking the line coding
  std::uint64_t strangers_ignored = 0;
};

class FrameTransport {
 public:
  FrameTransport() = default;
  FrameTransport(const FrameTransport&) = delete;
  FrameTransport& operator=(const FrameTransport&) = delete;
  virtual ~FrameTransport() = default;

  /// Sends one frame of fsw/link/frame.h. Throws LinkError.
  virtual void send(std::span<const std::uint8_t> frame) = 0;

  /// The next frame (its CRC unchecked), or an empty span if none came by `deadline`. Valid until the next call. Throws
  /// LinkError.
  virtual std::span<const std::uint8_t> receive(Clock::time_point deadline) = 0;

  [[nodiscard]] virtual TransportCounters counters() const = 0;
  [[nodiscard]] virtual std::string description() const = 0;
};

/// A line that takes no bytes for this long is dead: at 9600 baud a full window of frames needs about 45 s.
inline constexpr std::chrono::seconds kWritePatience{60};

}  // namespace vbar::pil
