#pragma once
// Command lines of the emulators, and the meaning of their counters.

#include <cstdint>
#include <string>
#include <vector>

namespace vbar::pil {

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
