#include "boards/zynq7000/console.h"

#include <array>
#include <cstddef>
#include <span>

#include "boards/zynq7000/memory_map.h"
#include "boards/zynq7000/uart.h"

namespace vbar::boards::zynq7000 {
namespace {

constexpr std::uint32_t kConsoleBaud = 115'200;
constexpr UartTransmitter kConsole(kUart1);

void put(char c) {
  const std::array<std::uint8_t, 1> byte{static_cast<std::uint8_t>(c)};
  static_cast<void>(kConsole.write(byte));  // a console without a reader must not stop anything
}

}  // namespace

void console_open() {
  kConsole.open(kConsoleBaud);
}

void print(const char* text) {
  for (; *text != '\0'; ++text) {
    if (*text == '\n') {
      put('\r');
    }
    put(*text);
  }
}

void print_decimal(std::uint64_t value) {
  std::array<char, 20> digits{};
  std::size_t count = 0;
  do {
    digits[count++] = static_cast<char>('0' + static_cast<char>(value % 10U));
    value /= 10U;
  } while (value != 0U);
  while (count > 0) {
    put(digits[--count]);
  }
}

void print_hex(std::uint32_t value) {
  for (unsigned shift = 32; shift > 0; shift -= 4) {
    put("0123456789abcdef"[(value >> (shift - 4U)) & 0xFU]);
  }
}

}  // namespace vbar::boards::zynq7000
