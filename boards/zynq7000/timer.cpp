#include "boards/zynq7000/timer.h"

#include "boards/zynq7000/memory_map.h"

namespace vbar::boards::zynq7000 {
namespace {

constexpr std::uintptr_t kTimerLow = kGlobalTimer + 0x0U;
constexpr std::uintptr_t kTimerHigh = kGlobalTimer + 0x4U;
constexpr std::uintptr_t kTimerControl = kGlobalTimer + 0x8U;

bool cycles_count = false;
std::uint32_t last_cycles = 0;
std::uint64_t last_timer = 0;
std::uint64_t cycles_total = 0;

std::uint32_t cycle_counter() {
  std::uint32_t value = 0;
  asm volatile("isb\n\tmrc p15, 0, %0, c9, c13, 0" : "=r"(value)::"memory");  // PMCCNTR
  return value;
}

void start_cycle_counter() {
  constexpr std::uint32_t kEnableAndReset = (1U << 0) | (1U << 2);
  constexpr std::uint32_t kCycleCounter = 1U << 31;
  asm volatile("mcr p15, 0, %0, c9, c12, 0" ::"r"(kEnableAndReset));       // PMCR
  asm volatile("mcr p15, 0, %0, c9, c12, 1\n\tisb" ::"r"(kCycleCounter));  // PMCNTENSET
}

std::uint64_t total_cycles() {
  const std::uint32_t cycles = cycle_counter();
  const std::uint64_t timer = global_timer();
  cycles_total += nearest_cycle_count(cycles - last_cycles, 2U * (timer - last_timer));
  last_cycles = cycles;
  last_timer = timer;
  return cycles_total;
}

}  // namespace

void timers_initialize() {
  reg(kTimerControl) =
      1;  // enabled, not prescaled; a debugger or loader may have left it running: only differences are used
  start_cycle_counter();
  const std::uint32_t before = cycle_counter();
  last_timer = global_timer();
  last_cycles = cycle_counter();
  cycles_count = last_cycles != before;
}

std::uint64_t global_timer() {
  // Two 32-bit halves: read again if the upper one has changed meanwhile. It changes every 12 seconds at most.
  std::uint32_t high = reg(kTimerHigh);
  std::uint32_t low = reg(kTimerLow);
  const std::uint32_t high_after = reg(kTimerHigh);
  if (high_after != high) {
    high = high_after;
    low = reg(kTimerLow);
  }
  return (static_cast<std::uint64_t>(high) << 32) | low;
}

CounterUnit cost_counter_unit() {
  return cycles_count ? CounterUnit::kCycles : CounterUnit::kEmulatedTimerTicks;
}

std::uint64_t cost_counter() {
  return cycles_count ? total_cycles() : global_timer();
}

}  // namespace vbar::boards::zynq7000
