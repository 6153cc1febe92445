#include <array>

#include "boards/zynq7000/faults.h"

namespace vbar::boards::zynq7000 {
namespace {

constexpr std::uint32_t kExitExtended = 0x20;
constexpr std::uint32_t kGetCommandLine = 0x15;
constexpr std::uint32_t kApplicationExit = 0x20026;  // ADP_Stopped_ApplicationExit

std::int32_t semihosting_call(std::uint32_t operation, const void* arguments) {
  register std::uint32_t r0 asm("r0") = operation;
  register const void* r1 asm("r1") = arguments;
  asm volatile("svc 0x123456" : "+r"(r0) : "r"(r1) : "memory", "cc");
  return static_cast<std::int32_t>(r0);
}

}  // namespace

void semihosting_exit(std::uint32_t code) {
  const std::array<std::uint32_t, 2> arguments{kApplicationExit, code};
  static_cast<void>(semihosting_call(kExitExtended, arguments.data()));
}

bool semihosting_command_line(std::span<char> text) {
  struct {
    char* text;
    std::size_t size;
  } arguments{text.data(), text.size()};
  return semihosting_call(kGetCommandLine, &arguments) == 0;
}

}  // namespace vbar::boards::zynq7000
