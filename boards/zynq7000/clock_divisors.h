#pragma once
// Divisors of the peripheral clocks, from the actual frequencies of the clock tree. Pure arithmetic.

#include <cstdint>

namespace vbar::boards::zynq7000 {

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
