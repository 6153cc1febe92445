#pragma once
// The layer under the step barrier: a frame transport, which is either COBS over a byte channel (host_sim/io) or
// datagrams. One thread; calls return by a deadline.

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "fsw/link/frame.h"
#include "host_sim/io/byte_channel.h"
#include "host_sim/io/file_descriptor.h"

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

// Frames over a byte channel: COBS-encoded, a zero byte after each.

class StreamTransport final : public FrameTransport {
 public:
  explicit StreamTransport(std::unique_ptr<ByteChannel> channel) : channel_(std::move(channel)) {}

  void send(std::span<const std::uint8_t> frame) override;
  std::span<const std::uint8_t> receive(Clock::time_point deadline) override;
  [[nodiscard]] TransportCounters counters() const override;
  [[nodiscard]] std::string description() const override { return channel_->description(); }

 private:
  std::unique_ptr<ByteChannel> channel_;
  fsw::link::CobsDecoder decoder_;
  std::array<std::uint8_t, fsw::link::kMaxCobsFrameBytes + 1> coded_{};
  std::span<const std::uint8_t> undecoded_;  ///< remaining bytes of the channel's last delivery
  bool first_ = true;
  TransportCounters counters_;
};

// Frames over UDP, one per datagram, to and from one fixed address.

/// Datagrams that come from any other address than `peer` are ignored and counted (io::UdpSocket). Throws LinkError.
std::unique_ptr<FrameTransport> make_udp_transport(const std::string& peer_address, std::uint16_t peer_port,
                                                   std::uint16_t local_port = 0);

/// Makes the same on a socket that is bound already.
std::unique_ptr<FrameTransport> make_udp_transport(io::FileDescriptor bound_socket, const std::string& peer_address,
                                                   std::uint16_t peer_port);

}  // namespace vbar::pil
