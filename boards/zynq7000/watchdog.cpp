#include "boards/zynq7000/watchdog.h"

#include <algorithm>

#include "boards/zynq7000/console.h"
#include "boards/zynq7000/interrupts.h"
#include "boards/zynq7000/memory_map.h"
#include "boards/zynq7000/timer.h"

namespace vbar::boards::zynq7000 {
namespace {

// Both count down at the rate of the global timer, divided by a prescaler of 1 to 256 (Cortex-A9 MPCore TRM, DDI 0407,
// chapter 4).
constexpr std::uintptr_t kLoad = kPrivateWatchdog + 0x00U;
constexpr std::uintptr_t kControl = kPrivateWatchdog + 0x08U;
constexpr std::uintptr_t kTimerLoad = kPrivateTimer + 0x00U;
constexpr std::uintptr_t kTimerControl = kPrivateTimer + 0x08U;
constexpr std::uintptr_t kTimerStatus = kPrivateTimer + 0x0CU;
constexpr std::uint32_t kEnable = 1U << 0;
constexpr std::uint32_t kReload = 1U << 1;
constexpr std::uint32_t kInterrupt = 1U << 2;
constexpr std::uint32_t kWatchdogMode = 1U << 3;
constexpr unsigned kPrescalerShift = 8;
constexpr std::uint64_t kWakeSpan = timer_span_ms(100);

std::uint32_t load = 0;
std::uint32_t control = 0;

bool is_emulated() {
  return cost_counter_unit() == CounterUnit::kEmulatedTimerTicks;
}

void on_expiry(void* /*context*/) {
  print("\nWATCHDOG expired\n");
  // QEMU 7.2 retains the priority of an interrupt that has not ended through the reset, and takes no other one after
  // it.
  interrupts_end(kInterruptPrivateWatchdog);
  reset_by_watchdog();
}

void start_wake_timer() {
  interrupts_attach_urgent(
      kInterruptPrivateTimer, [](void*) { reg(kTimerStatus) = 1; }, nullptr);
  reg(kTimerLoad) = static_cast<std::uint32_t>(kWakeSpan);
  reg(kTimerControl) = kEnable | kReload | kInterrupt;
}

}  // namespace

void watchdog_start(std::uint64_t span) {
  const std::uint64_t prescaler = std::min<std::uint64_t>(span >> 32, 255);
  const bool is_running = control != 0;
  load = static_cast<std::uint32_t>(std::min<std::uint64_t>(span / (prescaler + 1U), 0xFFFFFFFFU));
  control = kEnable | kInterrupt | kWatchdogMode | (static_cast<std::uint32_t>(prescaler) << kPrescalerShift);
  if (!is_running) {
    interrupts_attach_urgent(kInterruptPrivateWatchdog, &on_expiry, nullptr);
    if (!is_emulated()) {
      start_wake_timer();
    }
  }
  watchdog_feed();
  reg(kControl) = control;
}

// A write of the load register restarts the count.
void watchdog_feed() {
  reg(kLoad) = load;
}

void watchdog_before_wait() {
  if (is_emulated()) {
    reg(kControl) = 0;
  }
}

void watchdog_after_wait() {
  if (is_emulated()) {
    watchdog_feed();
    reg(kControl) = control;
  }
}

}  // namespace vbar::boards::zynq7000
