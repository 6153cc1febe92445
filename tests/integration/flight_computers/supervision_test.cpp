// The budget of a step and the watchdog of the bare-metal image on the emulated Zynq-7000, with a test article whose
// step at GPS time t takes t turns of a loop.

#include <chrono>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fsw/packets/messages.h"
#include "tests/integration/flight_computers/echo_computer.h"

namespace vbar::pil {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::uint64_t kBudget = 2'000'000;  // instructions
constexpr std::int64_t kShort = 1'000;        // turns of about ten instructions
constexpr std::int64_t kLong = 500'000;
constexpr std::int64_t kEndless = std::int64_t{1} << 60;

Packet tick_at(std::uint32_t step, std::int64_t gps_time_ns) {
  fsw::packets::PacketHeader header;
  header.time.ns = gps_time_ns;
  header.spacecraft = test::kSpacecraft;
  vbar::tick tick{};
  tick.step = step;
  tick.period_ns = 1;
  std::array<std::uint8_t, fsw::packets::kMaxPacketBytes> bytes{};
  const auto size = fsw::packets::encode(header, tick, bytes);
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size.value())};
}

class Supervision : public testing::TestWithParam<LinkKind> {
 protected:
  void SetUp() override {
    options_.image = vbar::tests::source_path("build/zynq/vbar_zynq7000_overrunning.elf");
    options_.step_budget = kBudget;
    if (!test::has_image(options_)) GTEST_SKIP() << "build/zynq/vbar_zynq7000_overrunning.elf is not built";
    computer_ = make_flight_computer(options_);
  }

  StepReport fly(std::uint32_t step, std::int64_t turns) {
    const Packet tick = tick_at(step, turns);
    return computer_->step(step, std::span(&tick, 1)).report;
  }
  std::string failure(std::uint32_t step, std::int64_t turns) {
    try {
      (void)fly(step, turns);
    } catch (const FlightComputerError& error) {
      return error.what();
    }
    return "no failure";
  }

  FlightComputerOptions options_ = test::echo_options(Target::kZynqQemu, GetParam());
  std::unique_ptr<FlightComputer> computer_;
};

TEST_P(Supervision, AStepWithinItsBudgetPassesAndOneBeyondIsAFailureWithBothNumbers) {
  const StepReport within = fly(0, kShort);
  EXPECT_EQ(within.unit, "instructions");
  EXPECT_GT(within.count, static_cast<std::uint64_t>(kShort));
  EXPECT_LT(within.count, kBudget);
  const std::uint64_t expected = within.count * (kLong / kShort);  // a loop and little else
  const std::string text = failure(1, kLong);
  EXPECT_THAT(
      text, AllOf(HasSubstr("failed at step 1: the step took "), HasSubstr(" instructions, and its budget is 2000000"),
                  HasSubstr("step 1 exceeded its budget")));
  const std::size_t at = text.find("took ") + 5;
  const std::uint64_t counted = std::stoull(text.substr(at));
  EXPECT_GT(counted, kBudget);
  EXPECT_NEAR(static_cast<double>(counted), static_cast<double>(expected), 0.05 * static_cast<double>(expected));
}

TEST_P(Supervision, AStepThatDoesNotEndIsEndedByTheWatchdogAndTheHostIsToldWhy) {
  (void)fly(0, kShort);
  const auto start = std::chrono::steady_clock::now();
  const std::string text = failure(1, kEndless);
  EXPECT_THAT(text,
              AllOf(HasSubstr("failed at step 1: the board has lost its session: its watchdog reset it in step 1"),
                    HasSubstr("the budget of a step is 2000000 instructions"), HasSubstr("WATCHDOG expired"),
                    HasSubstr("reset by the watchdog"), HasSubstr("ready")));
  // By its own answer: not because the host has lost patience.
  EXPECT_LT(std::chrono::steady_clock::now() - start, options_.timing.give_up_after);
}

INSTANTIATE_TEST_SUITE_P(Links, Supervision, testing::Values(LinkKind::kSerial, LinkKind::kUdp),
                         [](const auto& of) { return std::string(name_of(of.param)); });

}  // namespace
}  // namespace vbar::pil
