#include "pil_bridge/qemu.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::pil {
namespace {

using testing::Contains;

// A tick is 10 ns and an instruction 2^shift ns of emulated time: at shift 6, 64 ns or 6.4 ticks.
TEST(Qemu, TurnsTimerTicksIntoInstructions) {
  EXPECT_EQ(instructions_of_ticks(0, 6), 0U);
  EXPECT_EQ(instructions_of_ticks(64, 6), 10U);
  EXPECT_EQ(instructions_of_ticks(32, 5), 10U);
  // The timer truncates: 442,000 instructions at shift 6 are 2,828,800 ticks exactly; one tick less still rounds to
  // them.
  EXPECT_EQ(instructions_of_ticks(2828800, 6), 442000U);
  EXPECT_EQ(instructions_of_ticks(2828799, 6), 442000U);
}

TEST(Qemu, TurnsInstructionsIntoTimerTicksAndBack) {
  EXPECT_EQ(ticks_of_instructions(10, 6), 64U);
  EXPECT_EQ(ticks_of_instructions(10, 5), 32U);
  for (const int shift : {5, 6, 7, 8})
    for (const std::uint64_t instructions : {1U, 7U, 442'001U, 250'000'000U})
      EXPECT_EQ(instructions_of_ticks(ticks_of_instructions(instructions, shift), shift), instructions);
}

TEST(Qemu, EmulationIsDeterministicAndIsolated) {
  const auto serial = zynq_qemu_over_serial("image.elf", 6, 3);
  EXPECT_THAT(serial, Contains("shift=6,sleep=off,align=off"));
  EXPECT_THAT(serial, Contains("image.elf"));
  EXPECT_THAT(serial, Contains("socket,id=link,fd=3"));
  const auto udp = zynq_qemu_over_udp("image.elf", 6, 16000);
  EXPECT_THAT(udp, Contains("user,model=cadence_gem,hostfwd=udp:127.0.0.1:16000-10.0.2.15:5000"));
}

// QEMU's first serial port is UART0 of the board. A comma within a value is written twice (QEMU's manual, -chardev).
TEST(Qemu, ConnectsAWiredReceiverToUart0) {
  const auto none = zynq_qemu_over_udp("image.elf", 6, 16000);
  EXPECT_EQ(*(std::ranges::find(none, "-serial") + 1), "null");
  const auto wired = zynq_qemu_over_udp("image.elf", 6, 16000, "/dev/a,b");
  EXPECT_THAT(wired, Contains("serial,id=receiver,path=/dev/a,,b"));
  EXPECT_EQ(*(std::ranges::find(wired, "-serial") + 1), "chardev:receiver");
}

}  // namespace
}  // namespace vbar::pil
