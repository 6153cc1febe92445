#pragma once
// Addresses and interrupt numbers of the Zynq-7000 processing system (Xilinx UG585, appendix B and chapter 7), and
// placement of this image's code and data. zynq7000.ld states the same memory layout; mmu.cpp maps it.

#include <cstdint>

namespace vbar::boards::zynq7000 {

/// Returns a device register. Device memory is mapped strongly enough that accesses are neither merged nor reordered.
inline volatile std::uint32_t& reg(std::uintptr_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

inline constexpr std::uintptr_t kUart0 = 0xE0000000U;
inline constexpr std::uintptr_t kUart1 = 0xE0001000U;
inline constexpr std::uintptr_t kGem0 = 0xE000B000U;
inline constexpr std::uintptr_t kSlcr = 0xF8000000U;
inline constexpr std::uintptr_t kInterruptCpuInterface = 0xF8F00100U;
inline constexpr std::uintptr_t kGlobalTimer = 0xF8F00200U;
inline constexpr std::uintptr_t kPrivateTimer = 0xF8F00600U;
inline constexpr std::uintptr_t kPrivateWatchdog = 0xF8F00620U;
inline constexpr std::uintptr_t kInterruptDistributor = 0xF8F01000U;
inline constexpr std::uintptr_t kLevel2Cache = 0xF8F02000U;

inline constexpr unsigned kInterruptPrivateTimer = 29;
inline constexpr unsigned kInterruptPrivateWatchdog = 30;
inline constexpr unsigned kInterruptGem0 = 54;
inline constexpr unsigned kInterruptUart0 = 59;
inline constexpr unsigned kInterruptUart1 = 82;

// One uncached section of 1 MiB holds the buffers of Ethernet's DMA and the data that outlast a reset. Names of the
// linker script.
inline constexpr std::uintptr_t kSectionBytes = 0x00100000U;
inline constexpr std::uintptr_t kImageStart = 0x00100000U;
inline constexpr std::uintptr_t kStackGuard = 0x03E00000U;  ///< unmapped: an overflowing stack faults here
inline constexpr std::uintptr_t kStackSection = 0x03F00000U;
inline constexpr std::uintptr_t kDmaPool = 0x04100000U;

}  // namespace vbar::boards::zynq7000
