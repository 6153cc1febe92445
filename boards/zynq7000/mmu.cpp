// Memory protection and caches: a flat map of 1 MiB sections (ARMv7-A short descriptors, DDI 0406 B3.5) and the level 2
// cache (PL310 TRM, DDI 0246; settings of UG585 chapter 3). Called once by startup.S, before .bss is cleared and with
// the MMU off: nothing here may use static data except the translation table.

#include <array>

#include "boards/zynq7000/cpu.h"
#include "boards/zynq7000/memory_map.h"

extern "C" {
// Symbol of zynq7000.ld: only its address is used.
extern char __writable_start[];
void vbar_memory_enable();
}

namespace vbar::boards::zynq7000 {
namespace {

constexpr std::uint32_t kSection = 0x2U;
constexpr std::uint32_t kNeverExecute = 1U << 4;
constexpr std::uint32_t kReadWrite = 0x3U << 10;
constexpr std::uint32_t kReadOnly = (1U << 15) | (0x1U << 10);
constexpr std::uint32_t kWriteBackCached = (1U << 12) | (1U << 3) | (1U << 2);  // TEX 001, C, B: allocate on write too
constexpr std::uint32_t kNotCached = 1U << 12;                                  // TEX 001: normal memory
constexpr std::uint32_t kDevice = 1U << 2;                                      // TEX 000, B: shared device

// Not shareable: one core, and the Cortex-A9 does not cache shareable memory unless it takes part in coherency
// (ACTLR.SMP).
constexpr std::uint32_t kCode = kSection | kReadOnly | kWriteBackCached;
constexpr std::uint32_t kData = kSection | kReadWrite | kWriteBackCached | kNeverExecute;
constexpr std::uint32_t kDma = kSection | kReadWrite | kNotCached | kNeverExecute;
constexpr std::uint32_t kRegisters = kSection | kReadWrite | kDevice | kNeverExecute;
constexpr std::uint32_t kUnmapped = 0;

[[gnu::section(".translation_table")]] alignas(16384) std::array<std::uint32_t, 4096> translation_table;

std::uint32_t attributes_of(std::uintptr_t address) {
  if (address >= kImageStart && address < kStackGuard) {
    return address < reinterpret_cast<std::uintptr_t>(__writable_start) ? kCode : kData;
  }
  if (address == kStackSection) {
    return kData;
  }
  if (address == kDmaPool) {
    return kDma;
  }
  const bool peripherals = address >= 0xE0000000U && address < 0xE0300000U;
  const bool system = address >= 0xF8000000U && address < 0xF9000000U;
  return peripherals || system ? kRegisters : kUnmapped;
}

// The random-access memory settings come from UG585 and Xilinx' answer record on the PL310 of the Zynq: the latencies
// required by its arrays, and one register of the SLCR that has no other description.
void enable_level2_cache() {
  constexpr std::uintptr_t kControl = kLevel2Cache + 0x100U;
  constexpr std::uintptr_t kAuxiliary = kLevel2Cache + 0x104U;
  constexpr std::uintptr_t kTagLatency = kLevel2Cache + 0x108U;
  constexpr std::uintptr_t kDataLatency = kLevel2Cache + 0x10CU;
  constexpr std::uintptr_t kInterruptClear = kLevel2Cache + 0x220U;
  constexpr std::uintptr_t kDrain = kLevel2Cache + 0x730U;
  constexpr std::uintptr_t kInvalidateByWay = kLevel2Cache + 0x77CU;
  constexpr std::uint32_t kAllWays = 0xFFU;

  reg(kControl) = 0;
  // 8 ways of 64 KiB, parity, instruction and data prefetch, early write response.
  reg(kAuxiliary) = (0x3U << 17) | (1U << 21) | (1U << 28) | (1U << 29) | (1U << 30);
  reg(kTagLatency) = 0x111U;
  reg(kDataLatency) = 0x121U;
  reg(kInvalidateByWay) = kAllWays;
  for (int i = 0; i < 1'000'000 && (reg(kInvalidateByWay) & kAllWays) != 0U; ++i) {
  }
  reg(kDrain) = 0;
  synchronize();
  reg(kInterruptClear) = 0x1FFU;
  reg(kSlcr + 0x008U) = 0xDF0DU;  // unlock
  reg(kSlcr + 0xA1CU) = 0x00020202U;
  reg(kControl) = 1;
  synchronize();
}

void enable_mmu_and_level1_caches() {
  const auto table = reinterpret_cast<std::uintptr_t>(translation_table.data());
  constexpr std::uintptr_t kWalksCached = 0x48U;  // inner and outer write-back, write-allocate
  std::uint32_t actlr = 0;
  asm volatile("mrc p15, 0, %0, c1, c0, 1" : "=r"(actlr));
  actlr &= ~((1U << 6) | 1U);  // SMP, FW: a boot loader may have set them
  asm volatile("mcr p15, 0, %0, c1, c0, 1" ::"r"(actlr));
  asm volatile("mcr p15, 0, %0, c2, c0, 2" ::"r"(0));                     // TTBCR: one table
  asm volatile("mcr p15, 0, %0, c2, c0, 0" ::"r"(table | kWalksCached));  // TTBR0
  asm volatile("mcr p15, 0, %0, c3, c0, 0" ::"r"(1));                     // DACR: domain 0, permissions checked
  asm volatile("mcr p15, 0, %0, c8, c7, 0\n\tdsb\n\tisb" ::"r"(0));       // TLBIALL
  std::uint32_t sctlr = 0;
  asm volatile("mrc p15, 0, %0, c1, c0, 0" : "=r"(sctlr));
  sctlr |= (1U << 0) | (1U << 2) | (1U << 11) | (1U << 12);  // M, C, Z, I
  asm volatile("mcr p15, 0, %0, c1, c0, 0\n\tisb" ::"r"(sctlr) : "memory");
}

}  // namespace
}  // namespace vbar::boards::zynq7000

void vbar_memory_enable() {
  using namespace vbar::boards::zynq7000;
  for (std::size_t i = 0; i < translation_table.size(); ++i) {
    const std::uintptr_t address = i * kSectionBytes;
    const std::uint32_t attributes = attributes_of(address);
    translation_table[i] = attributes == kUnmapped ? kUnmapped : static_cast<std::uint32_t>(address) | attributes;
  }
  synchronize();
  enable_level2_cache();
  enable_mmu_and_level1_caches();
}
