#pragma once
// The clock tree as left by the boot loader (or the emulator), and the clock gates of the peripherals used here.
// The PLLs, the DDR controller and the pins are set by the first-stage loader (docs/board_bringup.md).

#include <cstdint>

namespace vbar::boards::zynq7000 {

/// Crystal of the processing system, Hz: 33 1/3 MHz on the ZedBoard, the ZC702, the MicroZed and the emulator.
inline constexpr std::uint32_t kCrystalHz = 33'333'333U;

/// Ethernet's line rates.
enum class LineRate : std::uint8_t { k10Mbps, k100Mbps, k1000Mbps };

/// Enables the bus clocks of both UARTs and Ethernet, and the reference clock of the UARTs; divisors are unchanged.
void clocks_enable_peripherals();

/// Returns the reference clock of the UARTs, Hz.
std::uint32_t uart_reference_hz();

/// Sets the transmit clock of Ethernet: 2.5, 25 or 125 MHz, from the I/O PLL; its receive clock comes from the PHY.
void clocks_set_ethernet(LineRate rate);

}  // namespace vbar::boards::zynq7000
