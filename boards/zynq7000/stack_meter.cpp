#include "boards/zynq7000/stack_meter.h"

extern "C" {
// Symbols of zynq7000.ld: only their addresses are used.
extern const std::uint32_t __stack_bottom[];
extern const std::uint32_t __stack_top[];
}

namespace vbar::boards::zynq7000 {
namespace {
constexpr std::uint32_t kStackPaint = 0xDEADBEEF;  // STACK_PAINT of startup.S
}  // namespace

std::uint32_t stack_high_water() {
  const volatile std::uint32_t* word = __stack_bottom;  // volatile: not written by this code
  const volatile std::uint32_t* const top = __stack_top;
  while (word < top && *word == kStackPaint) {
    ++word;
  }
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(top) - reinterpret_cast<std::uintptr_t>(word));
}

}  // namespace vbar::boards::zynq7000
