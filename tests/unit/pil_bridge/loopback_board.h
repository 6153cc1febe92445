#pragma once
// A board in this process, without a line: frames go straight into its executive, and its frames wait to be received.

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "boards/common/flight_executive.h"
#include "pil_bridge/transport.h"

namespace vbar::pil::test {

class LoopbackBoard final : public FrameTransport {
 public:
  using Frame = std::vector<std::uint8_t>;

  LoopbackBoard() {
    boards::Platform platform;
    platform.context = this;
    platform.name = "loopback board";
    platform.send = [](void* context, std::span<const std::uint8_t> frame) {
      static_cast<LoopbackBoard*>(context)->to_host_.emplace_back(frame.begin(), frame.end());
    };
    executive_ = std::make_unique<boards::FlightExecutive>(platform);
  }

  void send(std::span<const std::uint8_t> frame) override { last_activity_ = executive_->on_frame(frame); }

  // With nothing to deliver, time passes at once: a wait that would end in a timeout is over.
  std::span<const std::uint8_t> receive(Clock::time_point /*deadline*/) override {
    if (to_host_.empty()) return {};
    delivered_ = std::move(to_host_.front());
    to_host_.pop_front();
    return delivered_;
  }

  [[nodiscard]] TransportCounters counters() const override { return {}; }
  [[nodiscard]] std::string description() const override { return "loopback"; }
  [[nodiscard]] boards::Activity last_activity() const { return last_activity_; }

 private:
  std::unique_ptr<boards::FlightExecutive> executive_;
  std::deque<Frame> to_host_;
  Frame delivered_;
  boards::Activity last_activity_ = boards::Activity::kIdle;
};

}  // namespace vbar::pil::test
