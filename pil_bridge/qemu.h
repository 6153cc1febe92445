#pragma once
// Files of a build or an installation that the running program finds by their places relative to its own.

#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "host_sim/files/own_program.h"

namespace vbar::pil {

/// Paths relative to the program's folder: the file of an installation if there is one, else that of a build, whether
/// or not it exists.
inline std::string beside_program(const std::filesystem::path& installed, const std::filesystem::path& built) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path here = files::own_program().parent_path();
  const bool is_installed = fs::is_regular_file(here / installed, error);
  return (here / (is_installed ? installed : built)).lexically_normal().string();
}

// Whether a file is a program for the emulated ARM processor, by its ELF header: the emulators only fail to start, or
// execute what they are given.

/// Returns what `file` is instead of an ELF program for 32-bit ARM, little-endian, and what is accepted; empty if it is
/// one.
/// `is_for_linux`: also one that is relocated when it is loaded.
[[nodiscard]] std::string fault_of_arm_image(const std::string& file, bool is_for_linux);

// Command lines of the emulators, and the meaning of their counters.

/// A fixed number of instructions per unit of emulated time, `2^shift` ns each: with it the emulator is deterministic.
/// Below 5 the emulated clock cannot keep up with a serial link; above 8 the board's timers are slow without benefit.
inline constexpr int kMinIcountShift = 5;
inline constexpr int kGreatestIcountShift = 8;
inline constexpr int kDefaultIcountShift = 6;

/// `xilinx-zynq-a9` running `elf`, its frame link (UART0) on the connected stream socket that the emulator finds as
/// file descriptor `link_fd`, its console (UART1) on standard output.
std::vector<std::string> zynq_qemu_over_serial(const std::string& elf, int icount_shift, int link_fd);

/// Returns the command line with the frame link on Ethernet: UDP port `host_port` of 127.0.0.1 is forwarded to the
/// board's. UART0 is connected to the serial device `receiver`, if that is not empty.
std::vector<std::string> zynq_qemu_over_udp(const std::string& elf, int icount_shift, std::uint16_t host_port,
                                            const std::string& receiver = {});

/// An ARM Linux program under user-mode emulation.
std::vector<std::string> linux_arm_qemu(const std::string& program, const std::vector<std::string>& arguments);

/// Message of QEMU when another program took the forwarded port in the meantime.
inline constexpr const char* kPortTakenMessage = "Could not set up host forwarding rule";

/// Instructions executed while the emulated board's global timer (100 MHz, 10 ns a tick) counted `ticks`.
std::uint64_t instructions_of_ticks(std::uint64_t ticks, int icount_shift);
/// Its inverse, rounded: that of the result is `instructions` again.
std::uint64_t ticks_of_instructions(std::uint64_t instructions, int icount_shift);

}  // namespace vbar::pil
