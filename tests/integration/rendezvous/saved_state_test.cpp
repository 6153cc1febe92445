// The flight software's state is the bytes of one object, also with filters, receiver streams and epochs in waiting: a
// flight that saves and restores it time and again says what an undisturbed one says.

#include <cstring>
#include <new>
#include <utility>

#include <gtest/gtest.h>

#include "fsw/gnc/vbar_gnc.h"
#include "fsw/packets/packet.h"
#include "tests/integration/rendezvous/flown_mission.h"

namespace vbar::test {
namespace {

constexpr std::uint8_t kServicerNumber = 1;

/// Memory for the state, filled with a pattern that would be seen if anything in it were read before it is written.
class StateMemory {
 public:
  StateMemory() : bytes_(::operator new(vbar_gnc_state_size(), alignment())) {
    std::memset(bytes_, 0xA5, vbar_gnc_state_size());
  }
  ~StateMemory() { ::operator delete(bytes_, alignment()); }
  StateMemory(const StateMemory&) = delete;
  StateMemory& operator=(const StateMemory&) = delete;
  [[nodiscard]] void* get() const { return bytes_; }

 private:
  static std::align_val_t alignment() { return std::align_val_t(vbar_gnc_state_alignment()); }
  void* bytes_;
};

/// Moves its flight software to other memory between any two steps, and between packets and step.
class MovingComputer final : public pil::FlightComputer {
 public:
  MovingComputer() : state_(std::make_unique<StateMemory>()) {
    EXPECT_EQ(vbar_gnc_init(state_->get(), kServicerNumber, &MovingComputer::sink, &answer_), 0);
  }

  pil::StepResult step(std::uint32_t, std::span<const pil::Packet> packets) override {
    for (const pil::Packet& packet : packets) vbar_gnc_receive(state_->get(), packet.data(), packet.size());
    move();
    const auto last = fsw::packets::parse_packet(packets.back());
    EXPECT_TRUE(last.ok());
    EXPECT_EQ(vbar_gnc_step(state_->get(), last.value().header.time.ns), 0);
    move();
    pil::StepResult result;
    result.packets = std::exchange(answer_, {});
    return result;
  }
  [[nodiscard]] pil::LinkStatistics statistics() const override { return {}; }
  [[nodiscard]] std::string description() const override { return "moving"; }
  void close() override {}

 private:
  void move() {
    auto other = std::make_unique<StateMemory>();
    std::memcpy(other->get(), state_->get(), vbar_gnc_state_size());
    state_ = std::move(other);
    vbar_gnc_set_sink(state_->get(), &MovingComputer::sink, &answer_);
  }
  static void sink(void* answer, const std::uint8_t* packet, std::size_t size) {
    static_cast<std::vector<pil::Packet>*>(answer)->emplace_back(packet, packet + size);
  }

  std::unique_ptr<StateMemory> state_;
  std::vector<pil::Packet> answer_;
};

TEST(SavedState, OfCarrierPhaseNavigationFliesOn) {
  // Half an hour: receivers' first bytes, the first integers held, a plan and burns.
  const std::vector<std::string> arc{"mission.duration_h=0.5", "guidance.planner_delay_s=600"};
  const FlownMission undisturbed = fly("experiment3.toml", arc);
  const FlownMission moved = fly("experiment3.toml", arc, [](auto) { return std::make_unique<MovingComputer>(); });
  EXPECT_TRUE(moved.complete);
  EXPECT_FALSE(undisturbed.commands.empty());
  EXPECT_EQ(moved.commands, undisturbed.commands);
  EXPECT_EQ(moved.telemetry, undisturbed.telemetry);
}

}  // namespace
}  // namespace vbar::test
