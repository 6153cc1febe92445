#include "pil_bridge/qemu.h"

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

TEST(Qemu, EmulationIsDeterministicAndIsolated) {
  const auto serial = zynq_qemu_over_serial("image.elf", 6, 3);
  EXPECT_THAT(serial, Contains("shift=6,sleep=off,align=off"));
  EXPECT_THAT(serial, Contains("image.elf"));
  EXPECT_THAT(serial, Contains("socket,id=link,fd=3"));
  const auto udp = zynq_qemu_over_udp("image.elf", 6, 16000);
  EXPECT_THAT(udp, Contains("user,model=cadence_gem,hostfwd=udp:127.0.0.1:16000-10.0.2.15:5000"));
}

}  // namespace
}  // namespace vbar::pil
