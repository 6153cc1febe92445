#pragma once
// The clock tree as the boot loader (or the emulator) left it, and the switches of the peripherals this image uses.
// The PLLs, the DDR controller and the pins are the first-stage loader's business (docs/board_bringup.md).

#include <cstdint>

namespace vbar::boards::zynq7000 {

/// Crystal of the processing system, Hz: 33 1/3 MHz on the ZedBoard, the ZC702, the MicroZed and the emulator.
inline constexpr std::uint32_t kCrystalHz = 33'333'333U;

/// Ethernet's line rates.
enum class LineRate : std::uint8_t { k10Mbps, k100Mbps, k1000Mbps };

/// Gives both UARTs and Ethernet their bus clocks, and the UARTs their reference clock; divisors stay as they are.
void clocks_enable_peripherals();

/// Reference clock of the UARTs, Hz.
std::uint32_t uart_reference_hz();

/// Sets Ethernet's transmit clock: 2.5, 25 or 125 MHz, from the I/O PLL; its receive clock comes from the PHY's pins.
void clocks_set_ethernet(LineRate rate);

}  // namespace vbar::boards::zynq7000
