#pragma once
// Frames over a byte channel: COBS-encoded, a zero byte after each.

#include <array>
#include <memory>

#include "fsw/link/cobs.h"
#include "pil_bridge/transport.h"

namespace vbar::pil {

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

}  // namespace vbar::pil
