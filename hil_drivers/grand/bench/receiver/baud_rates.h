#pragma once
// Baud rates of the receiver's serial ports (OEM6 Firmware Reference Manual OM-20000129, command SERIALCONFIG).

#include <algorithm>
#include <array>

namespace vbar::grand::bench {

inline constexpr std::array<unsigned, 9> kBaudRates{2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800};
inline constexpr unsigned kFactoryBaud = 9600;

constexpr bool is_baud_rate(unsigned baud) {
  return std::ranges::find(kBaudRates, baud) != kBaudRates.end();
}

}  // namespace vbar::grand::bench
