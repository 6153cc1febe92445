#include "pil_bridge/link_faults.h"

#include <deque>
#include <random>
#include <thread>
#include <utility>
#include <vector>

namespace vbar::pil {
namespace {

/// Random draws independent of the standard library: the engine is specified to the bit, its distributions are not.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  bool happens(double probability) {
    constexpr double kScale = 0x1p-53;
    return probability > 0.0 && static_cast<double>(engine_() >> 11U) * kScale < probability;
  }
  std::size_t below(std::size_t bound) { return static_cast<std::size_t>(engine_() % bound); }

 private:
  std::mt19937_64 engine_;
};

constexpr std::uint64_t kReceiveStream = 0x9E3779B97F4A7C15U;  ///< separates the draws of the two directions

class FaultyChannel final : public ByteChannel {
 public:
  FaultyChannel(std::unique_ptr<ByteChannel> channel, const LinkFaults& faults)
      : channel_(std::move(channel)), faults_(faults), send_(faults.seed), receive_(faults.seed ^ kReceiveStream) {}

  void write(std::span<const std::uint8_t> bytes, Clock::time_point deadline) override {
    damage(send_, bytes);
    channel_->write(damaged_, deadline);
  }

  std::span<const std::uint8_t> read(Clock::time_point deadline) override {
    for (;;) {
      const auto bytes = channel_->read(deadline);
      damage(receive_, bytes);
      if (bytes.empty() || !damaged_.empty()) return damaged_;
    }
  }

  [[nodiscard]] std::string description() const override { return channel_->description() + " (with byte faults)"; }

 private:
  void damage(Dice& dice, std::span<const std::uint8_t> bytes) {
    damaged_.clear();
    for (const std::uint8_t byte : bytes) {
      if (dice.happens(faults_.drop_byte_per_byte)) continue;
      const unsigned flipped = dice.happens(faults_.flip_bit_per_byte) ? 1U << dice.below(8) : 0U;
      damaged_.push_back(static_cast<std::uint8_t>(byte ^ flipped));
    }
  }

  std::unique_ptr<ByteChannel> channel_;
  LinkFaults faults_;
  Dice send_;
  Dice receive_;
  std::vector<std::uint8_t> damaged_;
};

/// One direction of a degraded line: output frames for input frames.
class FrameMangler {
 public:
  using Frame = std::vector<std::uint8_t>;
  FrameMangler(const LinkFaults& faults, std::uint64_t seed) : faults_(faults), dice_(seed) {}

  void take(std::span<const std::uint8_t> bytes) {
    if (dice_.happens(faults_.stall_per_frame)) std::this_thread::sleep_for(faults_.stall);
    if (dice_.happens(faults_.drop_frame)) return;
    Frame frame(bytes.begin(), bytes.end());
    if (!frame.empty() && dice_.happens(faults_.flip_bit_per_frame)) {
      const std::size_t bit = dice_.below(8 * frame.size());
      frame[bit / 8] = static_cast<std::uint8_t>(frame[bit / 8] ^ (1U << (bit % 8)));
    }
    if (late_.empty() && dice_.happens(faults_.delay_frame)) {
      late_ = std::move(frame);
      return;
    }
    if (dice_.happens(faults_.duplicate_frame)) out_.push_back(frame);
    out_.push_back(std::move(frame));
    if (!late_.empty()) out_.push_back(std::exchange(late_, {}));
  }

  [[nodiscard]] bool empty() const { return out_.empty(); }
  Frame pop() {
    Frame frame = std::move(out_.front());
    out_.pop_front();
    return frame;
  }

 private:
  LinkFaults faults_;
  Dice dice_;
  std::deque<Frame> out_;
  Frame late_;
};

class FaultyTransport final : public FrameTransport {
 public:
  FaultyTransport(std::unique_ptr<FrameTransport> transport, const LinkFaults& faults)
      : transport_(std::move(transport)), send_(faults, faults.seed), receive_(faults, faults.seed ^ kReceiveStream) {}

  void send(std::span<const std::uint8_t> frame) override {
    send_.take(frame);
    while (!send_.empty()) transport_->send(send_.pop());
  }

  std::span<const std::uint8_t> receive(Clock::time_point deadline) override {
    while (receive_.empty()) {
      const auto frame = transport_->receive(deadline);
      if (frame.empty()) return {};
      receive_.take(frame);
    }
    delivered_ = receive_.pop();
    return delivered_;
  }

  [[nodiscard]] TransportCounters counters() const override { return transport_->counters(); }
  [[nodiscard]] std::string description() const override { return transport_->description() + " (with frame faults)"; }

 private:
  std::unique_ptr<FrameTransport> transport_;
  FrameMangler send_;
  FrameMangler receive_;
  FrameMangler::Frame delivered_;
};

}  // namespace

std::unique_ptr<ByteChannel> with_byte_faults(std::unique_ptr<ByteChannel> channel, const LinkFaults& faults) {
  return std::make_unique<FaultyChannel>(std::move(channel), faults);
}

std::unique_ptr<FrameTransport> with_frame_faults(std::unique_ptr<FrameTransport> transport, const LinkFaults& faults) {
  return std::make_unique<FaultyTransport>(std::move(transport), faults);
}

}  // namespace vbar::pil
