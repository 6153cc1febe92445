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

// Divisors of the peripheral clocks, from the actual frequencies of the clock tree. Pure arithmetic.

struct BaudDivisors {
  std::uint32_t generator = 1;  ///< BAUDGEN.CD, 1 to 65535
  std::uint32_t divider = 4;    ///< BAUDDIV.BDIV, 4 to 255
};

/// Returns the divisors nearest to `baud` = clock / (generator * (divider + 1)), UG585 chapter 19. Among equals the
/// smallest divider is chosen, which has the fewest samples per bit but the finest resolution of the generator.
constexpr BaudDivisors baud_divisors(std::uint32_t clock_hz, std::uint32_t baud) {
  BaudDivisors best;
  std::uint32_t min_error = 0xFFFFFFFFU;
  for (std::uint32_t divider = 4; divider <= 255U; ++divider) {
    const std::uint32_t per_step = baud * (divider + 1U);
    std::uint32_t generator = (clock_hz + per_step / 2U) / per_step;
    generator = generator < 1U ? 1U : (generator > 0xFFFFU ? 0xFFFFU : generator);
    const std::uint32_t reached = clock_hz / (generator * (divider + 1U));
    const std::uint32_t error = reached > baud ? reached - baud : baud - reached;
    if (error < min_error) {
      min_error = error;
      best = {generator, divider};
    }
  }
  return best;
}

struct ClockDivisors {
  std::uint32_t first = 1;   ///< 1 to 63
  std::uint32_t second = 1;  ///< 1 to 63
};

/// Returns two six-bit divisors whose product is nearest to source / wanted; among equals the greatest first one.
constexpr ClockDivisors clock_divisors(std::uint32_t source_hz, std::uint32_t wanted_hz) {
  const std::uint32_t wanted = (source_hz + wanted_hz / 2U) / wanted_hz;
  ClockDivisors best;
  std::uint32_t min_error = 0xFFFFFFFFU;
  for (std::uint32_t second = 1; second <= 63U; ++second) {
    std::uint32_t first = (wanted + second / 2U) / second;
    first = first < 1U ? 1U : (first > 63U ? 63U : first);
    const std::uint32_t product = first * second;
    const std::uint32_t error = product > wanted ? product - wanted : wanted - product;
    if (error < min_error) {
      min_error = error;
      best = {first, second};
    }
  }
  return best;
}

}  // namespace vbar::boards::zynq7000
