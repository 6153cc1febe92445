#include <algorithm>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "pil_bridge/qemu.h"
#include "pil_bridge/remote_computer.h"

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

// Headers by the ELF specification (System V ABI, 4th edition, figure 4-3): offsets 4 class, 5 data, 16 type, 18
// machine.

namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class ArmImage : public testing::Test {
 protected:
  ArmImage() : file_(testing::TempDir() + "vbar_image_" + std::to_string(::getpid())) {}
  ~ArmImage() override { std::filesystem::remove(file_); }

  [[nodiscard]] std::string fault_of(const std::string& content, bool is_for_linux = false) const {
    std::ofstream(file_, std::ios::binary) << content;
    return fault_of_arm_image(file_, is_for_linux);
  }
  static std::string header(char bits, char data, char type, char machine) {
    std::string text(
        "\x7f"
        "ELF",
        4);
    text.resize(52, '\0');
    text[4] = bits;
    text[5] = data;
    text[16] = type;
    text[18] = machine;
    return text;
  }

  std::string file_;
};

TEST_F(ArmImage, AnExecutableForArmIsAccepted) {
  EXPECT_THAT(fault_of(header(1, 1, 2, 40)), IsEmpty());
  EXPECT_THAT(fault_of(header(1, 1, 3, 40), true), IsEmpty());
}

TEST_F(ArmImage, AnythingElseIsNamed) {
  EXPECT_THAT(fault_of("a text"), HasSubstr("not an ELF image; accepted: an ELF executable for 32-bit ARM"));
  EXPECT_THAT(fault_of(""), HasSubstr("not an ELF image"));
  EXPECT_THAT(fault_of(header(1, 1, 2, 40).substr(0, 12)), HasSubstr("not an ELF image"));
  EXPECT_THAT(fault_of(header(1, 2, 2, 40)), HasSubstr("big-endian"));
  EXPECT_THAT(fault_of(header(2, 1, 3, 62)), HasSubstr("64 bits for the machine number 62"));
  EXPECT_THAT(fault_of(header(1, 1, 1, 40)), HasSubstr("type 1, which is not an executable"));
  EXPECT_THAT(fault_of(header(1, 1, 3, 40)), HasSubstr("not an executable")) << "bare metal relocates nothing";
  EXPECT_THAT(fault_of_arm_image("/bin/true", false), HasSubstr("found an ELF image")) << "of this computer";
  EXPECT_THAT(fault_of_arm_image("/nowhere", false), HasSubstr("not an ELF image"));
}

}  // namespace

// How the time of an exchange is divided between a line and the flight computer.

namespace {

// 8N1: ten bits a byte. 3840 bytes at 38400 baud take 1 s.
TEST(ComputingTime, IsWhatTheBytesLeaveOfTheExchangeOnALineOfAKnownRate) {
  EXPECT_DOUBLE_EQ(computing_time(1.25, 0.0, 3840, 38400.0), 0.25);
  EXPECT_DOUBLE_EQ(computing_time(1.25, 1.0, 0, 38400.0), 1.25);
}

TEST(ComputingTime, IsTheWaitForTheAnswerWithoutARate) {
  EXPECT_DOUBLE_EQ(computing_time(1.25, 0.5, 3840, 0.0), 0.5);
}

TEST(ComputingTime, IsWithinTheExchange) {
  EXPECT_DOUBLE_EQ(computing_time(0.5, 0.0, 3840, 38400.0), 0.0);
  EXPECT_DOUBLE_EQ(computing_time(0.5, -0.1, 0, 0.0), 0.0);
  EXPECT_DOUBLE_EQ(computing_time(0.5, 0.7, 0, 0.0), 0.5);
}

}  // namespace

}  // namespace vbar::pil
