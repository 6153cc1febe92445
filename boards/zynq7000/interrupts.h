#pragma once
// Generic interrupt controller (PL390): handlers of the interrupts of peripherals, which can be deferred, and of the
// core's own timers, which cannot.

#include <cstdint>

namespace vbar::boards::zynq7000 {

/// Serves an interrupt. Runs with interrupts masked, on the stack of the interrupted code. Must be short.
using InterruptHandler = void (*)(void* context);

/// Disables and detaches all interrupts, with none pending. To be called once, before a handler is attached.
void interrupts_initialize();

/// Attaches `handler(context)` to interrupt `id` (a shared peripheral interrupt, 32 to 95).
void interrupts_attach(unsigned id, InterruptHandler handler, void* context);

/// Attaches a handler to an interrupt of the core's own timers (16 to 31), also served during a PeripheralsDeferred.
void interrupts_attach_urgent(unsigned id, InterruptHandler handler, void* context);

/// Ends interrupt `id`, for a handler that serves it and does not return.
void interrupts_end(unsigned id);

namespace detail {
/// Replaces the priority mask of the processor's interface; returns the mask before.
std::uint32_t exchange_priority_mask(std::uint32_t mask);
inline constexpr std::uint32_t kAllInterrupts = 0xF0U;
inline constexpr std::uint32_t kUrgentInterrupts = 0x80U;
}  // namespace detail

/// Defers the interrupts of peripherals during the lifetime of this object.
class PeripheralsDeferred {
 public:
  PeripheralsDeferred() : before_(detail::exchange_priority_mask(detail::kUrgentInterrupts)) {}
  ~PeripheralsDeferred() { detail::exchange_priority_mask(before_); }
  PeripheralsDeferred(const PeripheralsDeferred&) = delete;
  PeripheralsDeferred& operator=(const PeripheralsDeferred&) = delete;

 private:
  std::uint32_t before_;
};

/// Serves the interrupts of peripherals during the lifetime of this object, also inside a PeripheralsDeferred.
class PeripheralsServed {
 public:
  PeripheralsServed() : before_(detail::exchange_priority_mask(detail::kAllInterrupts)) {}
  ~PeripheralsServed() { detail::exchange_priority_mask(before_); }
  PeripheralsServed(const PeripheralsServed&) = delete;
  PeripheralsServed& operator=(const PeripheralsServed&) = delete;

 private:
  std::uint32_t before_;
};

}  // namespace vbar::boards::zynq7000
