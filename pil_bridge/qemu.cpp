#include "pil_bridge/qemu.h"

namespace vbar::pil {
namespace {

constexpr std::uint64_t kNanosecondsPerTick = 10;

/// Ethernet address and port of boards/zynq7000.
constexpr const char* kBoardAddressAndPort = "10.0.2.15:5000";

std::vector<std::string> zynq_machine(const std::string& elf, int icount_shift) {
  return {"qemu-system-arm", "-M", "xilinx-zynq-a9", "-m", "256M", "-display", "none", "-monitor", "none",
          // A small translation buffer: the default is a gigabyte per machine.
          "-accel", "tcg,tb-size=64",
          // sleep=off: emulated time jumps while the board waits; align=off: it does not follow the wall clock.
          "-icount", "shift=" + std::to_string(icount_shift) + ",sleep=off,align=off",
          // The board ends the emulator when the run is over.
          "-semihosting-config", "enable=on,target=native", "-chardev", "stdio,id=console,signal=off", "-kernel", elf};
}

/// Returns the text as the value of an option: QEMU writes a comma twice.
std::string option_value(const std::string& text) {
  std::string value;
  for (const char c : text) value += c == ',' ? ",," : std::string(1, c);
  return value;
}

void append(std::vector<std::string>& arguments, std::initializer_list<std::string> more) {
  arguments.insert(arguments.end(), more);
}

}  // namespace

std::vector<std::string> zynq_qemu_over_serial(const std::string& elf, int icount_shift, int link_fd) {
  auto arguments = zynq_machine(elf, icount_shift);
  append(arguments, {"-chardev", "socket,id=link,fd=" + std::to_string(link_fd), "-serial", "chardev:link", "-serial",
                     "chardev:console", "-nic", "none"});
  return arguments;
}

std::vector<std::string> zynq_qemu_over_udp(const std::string& elf, int icount_shift, std::uint16_t host_port,
                                            const std::string& receiver) {
  auto arguments = zynq_machine(elf, icount_shift);
  if (!receiver.empty()) append(arguments, {"-chardev", "serial,id=receiver,path=" + option_value(receiver)});
  append(arguments,
         {"-serial", receiver.empty() ? "null" : "chardev:receiver", "-serial", "chardev:console", "-nic",
          "user,model=cadence_gem,hostfwd=udp:127.0.0.1:" + std::to_string(host_port) + "-" + kBoardAddressAndPort});
  return arguments;
}

std::vector<std::string> linux_arm_qemu(const std::string& program, const std::vector<std::string>& arguments) {
  std::vector<std::string> all{"qemu-arm", "-L", "/usr/arm-linux-gnueabihf", program};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return all;
}

std::uint64_t instructions_of_ticks(std::uint64_t ticks, int icount_shift) {
  const std::uint64_t instruction_ns = std::uint64_t{1} << static_cast<unsigned>(icount_shift);
  return (ticks * kNanosecondsPerTick + instruction_ns / 2) / instruction_ns;
}

std::uint64_t ticks_of_instructions(std::uint64_t instructions, int icount_shift) {
  const std::uint64_t instruction_ns = std::uint64_t{1} << static_cast<unsigned>(icount_shift);
  return (instructions * instruction_ns + kNanosecondsPerTick / 2) / kNanosecondsPerTick;
}

}  // namespace vbar::pil
