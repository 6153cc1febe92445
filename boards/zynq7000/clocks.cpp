#include "boards/zynq7000/clocks.h"

#include "boards/zynq7000/memory_map.h"

namespace vbar::boards::zynq7000 {
namespace {

// Registers of the SLCR (UG585, appendix B).
constexpr std::uintptr_t kUnlock = kSlcr + 0x008U;
constexpr std::uintptr_t kArmPll = kSlcr + 0x100U;
constexpr std::uintptr_t kDdrPll = kSlcr + 0x104U;
constexpr std::uintptr_t kIoPll = kSlcr + 0x108U;
constexpr std::uintptr_t kPeripheralBusClocks = kSlcr + 0x12CU;
constexpr std::uintptr_t kGem0ReceiveClock = kSlcr + 0x138U;
constexpr std::uintptr_t kGem0Clock = kSlcr + 0x140U;
constexpr std::uintptr_t kUartClock = kSlcr + 0x154U;
constexpr std::uint32_t kUnlockKey = 0xDF0DU;

std::uint32_t pll_hz(std::uintptr_t control) {
  constexpr std::uint32_t kForcedBypass = 1U << 4;
  const std::uint32_t value = reg(control);
  return (value & kForcedBypass) != 0U ? kCrystalHz : kCrystalHz * ((value >> 12) & 0x7FU);
}

}  // namespace

void clocks_enable_peripherals() {
  constexpr std::uint32_t kGem0Bus = 1U << 6;
  constexpr std::uint32_t kUart0Bus = 1U << 20;
  constexpr std::uint32_t kUart1Bus = 1U << 21;
  constexpr std::uint32_t kBothUarts = 0x3U;
  reg(kUnlock) = kUnlockKey;
  reg(kPeripheralBusClocks) = reg(kPeripheralBusClocks) | kGem0Bus | kUart0Bus | kUart1Bus;
  reg(kUartClock) = reg(kUartClock) | kBothUarts;
}

std::uint32_t uart_reference_hz() {
  const std::uint32_t control = reg(kUartClock);
  const std::uint32_t source = (control >> 4) & 0x3U;
  const std::uint32_t divisor = (control >> 8) & 0x3FU;
  const std::uintptr_t pll = source == 2U ? kArmPll : (source == 3U ? kDdrPll : kIoPll);
  return pll_hz(pll) / (divisor == 0U ? 1U : divisor);
}

void clocks_set_ethernet(LineRate rate) {
  constexpr std::uint32_t kActive = 1U;
  const std::uint32_t wanted_hz =
      rate == LineRate::k1000Mbps ? 125'000'000U : (rate == LineRate::k100Mbps ? 25'000'000U : 2'500'000U);
  const ClockDivisors divisors = clock_divisors(pll_hz(kIoPll), wanted_hz);
  reg(kUnlock) = kUnlockKey;
  reg(kGem0ReceiveClock) = kActive;
  reg(kGem0Clock) = (divisors.second << 20) | (divisors.first << 8) | kActive;
}

}  // namespace vbar::boards::zynq7000
