#pragma once
// A byte stream to another device or process: a serial line or a stream socket. One thread; every call returns by a
// deadline.

#include <chrono>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

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

}  // namespace vbar::io
