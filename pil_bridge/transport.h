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
/// The link to the flight computer has failed, or there is no answer on it.
using LinkError = io::ChannelError;

struct TransportCounters {
  std::uint64_t bytes_sent = 0;         ///< as encoded on the wire
  std::uint64_t bytes_received = 0;     ///< as encoded on the wire
  std::uint64_t frames_rejected = 0;    ///< dropped because of invalid line coding
  std::uint64_t foreign_datagrams = 0;  ///< from an address other than that of the peer, discarded
};

class FrameTransport {
 public:
  FrameTransport() = default;
  FrameTransport(const FrameTransport&) = delete;
  FrameTransport& operator=(const FrameTransport&) = delete;
  virtual ~FrameTransport() = default;

  /// Sends one frame of fsw/link/frame.h. Throws LinkError.
  virtual void send(std::span<const std::uint8_t> frame) = 0;

  /// The next frame (its CRC unchecked), or an empty span if none arrived by `deadline`. Valid until the next call.
  /// Throws LinkError.
  virtual std::span<const std::uint8_t> receive(Clock::time_point deadline) = 0;

  [[nodiscard]] virtual TransportCounters counters() const = 0;
  [[nodiscard]] virtual std::string description() const = 0;
};

/// A line that accepts no bytes for this long has failed: at 9600 baud a full window of frames needs about 45 s.
inline constexpr std::chrono::seconds kWritePatience{60};

}  // namespace vbar::pil
