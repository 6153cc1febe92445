#include "pil_bridge/qemu.h"

#include <cstddef>
#include <cstring>
#include <fstream>

#include <elf.h>

namespace vbar::pil {

std::string fault_of_arm_image(const std::string& file, bool is_for_linux) {
  Elf32_Ehdr header{};
  std::ifstream stream(file, std::ios::binary);
  stream.read(reinterpret_cast<char*>(&header), sizeof header);
  const std::string accepted = std::string("; accepted: an ELF executable for 32-bit ARM, little-endian") +
                               (is_for_linux ? ", of Linux" : ", bare metal");
  // The header of another class differs behind the type and the machine, which are read from it here.
  if (stream.gcount() < static_cast<std::streamsize>(offsetof(Elf32_Ehdr, e_version)) ||
      std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0)
    return "found a file that is not an ELF image" + accepted;
  if (header.e_ident[EI_DATA] != ELFDATA2LSB) return "found an ELF image that is big-endian" + accepted;
  if (header.e_ident[EI_CLASS] != ELFCLASS32 || header.e_machine != EM_ARM)
    return "found an ELF image of " + std::string(header.e_ident[EI_CLASS] == ELFCLASS64 ? "64" : "32") +
           " bits for the machine number " + std::to_string(header.e_machine) + accepted;
  if (header.e_type != ET_EXEC && !(is_for_linux && header.e_type == ET_DYN))
    return "found an ELF file of type " + std::to_string(header.e_type) + ", which is not an executable" + accepted;
  return {};
}

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
