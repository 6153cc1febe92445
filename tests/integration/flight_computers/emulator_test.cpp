// The bare-metal image on the emulated Zynq-7000: the same bits as a call in this process, over its UART and its
// Ethernet, a cost in instructions that no circumstance changes, and nothing left behind when it dies.

#include <cstdint>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include "pil_bridge/remote_computer.h"
#include "tests/integration/flight_computers/echo_computer.h"
#include "tests/support/paths.h"

namespace vbar::pil {
namespace {

using test::echo_options;
using test::expected_outputs;
using testing::AllOf;
using testing::HasSubstr;
using vbar::test::packet_count;
using vbar::test::step_packets;

constexpr std::uint32_t kEmulatorSteps = 8;  // one of them takes more than a window of packets

struct Flight {
  std::vector<Packet> outputs;
  std::vector<std::uint64_t> instructions;  ///< of each step
  std::string unit;
  std::uint32_t stack_bytes = 0;
  LinkStatistics statistics;
};

Flight fly_emulated(const FlightComputerOptions& options) {
  const auto computer = make_flight_computer(options);
  Flight flight;
  for (std::uint32_t step = 0; step < kEmulatorSteps; ++step) {
    const auto result = computer->step(step, step_packets(step, packet_count(step)));
    flight.outputs.insert(flight.outputs.end(), result.packets.begin(), result.packets.end());
    flight.instructions.push_back(result.report.count);
    flight.unit = result.report.unit;
    flight.stack_bytes = result.report.stack_bytes;
  }
  flight.statistics = computer->statistics();
  computer->close();
  return flight;
}

class Emulator : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::has_image(echo_options(Target::kZynqQemu, LinkKind::kSerial))) {
      GTEST_SKIP() << "build/zynq/vbar_zynq7000_echo.elf is not built";
    }
  }
};

TEST_F(Emulator, GivesTheSamePacketsAndTheSameCostOverUartAndEthernet) {
  const Flight uart = fly_emulated(echo_options(Target::kZynqQemu, LinkKind::kSerial));
  const Flight ethernet = fly_emulated(echo_options(Target::kZynqQemu, LinkKind::kUdp));
  EXPECT_EQ(uart.outputs, expected_outputs(kEmulatorSteps));
  EXPECT_EQ(ethernet.outputs, uart.outputs);
  EXPECT_EQ(uart.unit, "instructions");
  EXPECT_EQ(ethernet.instructions, uart.instructions);
  // A payload and a packet are on the exerciser's stack; all of the board's stack is 1 MiB.
  EXPECT_GT(uart.stack_bytes, 2U * 1300U);
  EXPECT_LT(uart.stack_bytes, 64U * 1024U);
  EXPECT_EQ(uart.statistics.frames_rejected, 0U);
}

// Emulated time a number of times slower: the timer counts more ticks, for the same instructions.
TEST_F(Emulator, CountsTheSameInstructionsAtAnotherClock) {
  auto options = echo_options(Target::kZynqQemu, LinkKind::kUdp);
  const Flight usual = fly_emulated(options);
  options.icount_shift = kGreatestIcountShift;
  const Flight slower = fly_emulated(options);
  EXPECT_EQ(slower.outputs, usual.outputs);
  EXPECT_EQ(slower.instructions, usual.instructions);
}

// About 50 kB pass the UART in each direction; one byte in 10,000 is hit.
TEST_F(Emulator, ABadSerialLineChangesNoPacket) {
  auto options = echo_options(Target::kZynqQemu, LinkKind::kSerial);
  options.faults = {.seed = 6, .flip_bit_per_byte = 5e-5, .drop_byte_per_byte = 5e-5};
  options.timing.poll_after = std::chrono::milliseconds(200);
  const Flight bad = fly_emulated(options);
  EXPECT_EQ(bad.outputs, expected_outputs(kEmulatorSteps));
  EXPECT_GT(bad.statistics.frames_rejected, 0U);
  EXPECT_GT(bad.statistics.frames_resent, 0U);
}

TEST_F(Emulator, KilledInMidRunIsOneClearError) {
  const auto computer = make_flight_computer(echo_options(Target::kZynqQemu, LinkKind::kSerial));
  const int pid = dynamic_cast<RemoteComputer&>(*computer).process_id();
  (void)computer->step(0, step_packets(0, 1));
  ASSERT_EQ(::kill(pid, SIGKILL), 0);
  try {
    (void)computer->step(1, step_packets(1, 1));
    FAIL();
  } catch (const FlightComputerError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("flight computer zynq_qemu over serial failed at step 1: "),
                                    HasSubstr("qemu-system-arm: killed by signal 9 (Killed)")));
  }
  EXPECT_NE(::kill(pid, 0), 0);
}

TEST_F(Emulator, AnImageThatNeverAnswersIsGivenUp) {
  auto options = echo_options(Target::kZynqQemu, LinkKind::kSerial);
  // An ELF header and a program header of 4 bytes: an endless loop.
  const std::string file = testing::TempDir() + "vbar_endless_loop_" + std::to_string(::getpid());
  const auto word = [](std::uint32_t value) { return std::string(reinterpret_cast<const char*>(&value), 4); };
  std::ofstream(file, std::ios::binary) << std::string(
                                               "\x7f"
                                               "ELF\1\1\1\0\0\0\0\0\0\0\0\0\2\0\x28\0",
                                               20)
                                        << word(1) << word(84) << word(52) << word(0) << word(0x5000000)
                                        << word(52 | 32 << 16) << word(1 | 40 << 16) << word(0)  // of the file
                                        << word(1) << word(84) << word(84) << word(84) << word(4) << word(4) << word(5)
                                        << word(4)            // of the program
                                        << word(0xeafffffe);  // b .
  options.image = file;
  options.timing.boot_limit = std::chrono::milliseconds(500);
  try {
    (void)make_flight_computer(options);
    FAIL();
  } catch (const FlightComputerError& error) {
    EXPECT_THAT(error.what(), HasSubstr("failed while starting: "));
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace vbar::pil
