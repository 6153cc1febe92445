#pragma once
// The layer under the step barrier: a frame transport, which is either COBS over a byte channel (host_sim/io) or
// datagrams. One thread; calls return by a deadline.

#include <chrono>
#include <cstdint>
#include <span>
#include <string>

#include "host_sim/io/byte_channel.h"

namespace vbar::pil {

using io::ByteChannel;
using io::Clock;
/// The link to the flight computer does not work any more, or nobody answers on it.
using LinkError = io::ChannelError;

struct TransportCounters {
  std::uint64_t bytes_sent = 0;         ///< as coded for the wire
  std::uint64_t bytes_received = 0;     ///< likewise
  std::uint64_t frames_rejected = 0;    ///< dropped for breaking the line coding
  std::uint64_t foreign_datagrams = 0;  ///< from other addresses than the peer's, discarded
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
