#pragma once
// Text output on UART1. Available from the first instruction of main on, and in fault handlers.

#include <cstdint>

namespace vbar::boards::zynq7000 {

void console_open();
void print(const char* text);
void print_decimal(std::uint64_t value);
/// Prints eight hexadecimal digits.
void print_hex(std::uint32_t value);

}  // namespace vbar::boards::zynq7000
