#pragma once
// Instructions of the Cortex-A9 that are not available in C++.

#include <cstdint>

namespace vbar::boards::zynq7000 {

/// Completes all accesses before, device writes included, before any instruction after is executed.
inline void synchronize() {
  asm volatile("dsb" ::: "memory");
}

/// Orders memory accesses: other masters observe those before ahead of those after.
inline void memory_barrier() {
  asm volatile("dmb" ::: "memory");
}

/// Sleeps until an interrupt is pending, masked or not.
inline void wait_for_interrupt() {
  asm volatile("dsb\n\twfi" ::: "memory");
}

namespace detail {
inline constexpr std::uint32_t kInterruptMaskBit = 1U << 7;

inline std::uint32_t status_register() {
  std::uint32_t cpsr = 0;
  asm volatile("mrs %0, cpsr" : "=r"(cpsr)::"memory");
  return cpsr;
}
inline void mask_interrupts() {
  asm volatile("cpsid i" ::: "memory");
}
inline void unmask_interrupts() {
  asm volatile("cpsie i" ::: "memory");
}
inline void restore_interrupts(std::uint32_t cpsr) {
  if ((cpsr & kInterruptMaskBit) != 0U) {
    mask_interrupts();
  } else {
    unmask_interrupts();
  }
}
}  // namespace detail

/// Masks interrupts during the lifetime of this object.
class InterruptsMasked {
 public:
  InterruptsMasked() : before_(detail::status_register()) { detail::mask_interrupts(); }
  ~InterruptsMasked() { detail::restore_interrupts(before_); }
  InterruptsMasked(const InterruptsMasked&) = delete;
  InterruptsMasked& operator=(const InterruptsMasked&) = delete;

 private:
  std::uint32_t before_;
};

}  // namespace vbar::boards::zynq7000
