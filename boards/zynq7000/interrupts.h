#pragma once
// The generic interrupt controller (PL390): which handler serves which shared interrupt.

namespace vbar::boards::zynq7000 {

/// Runs with interrupts masked, on the stack of whatever it interrupted. Must be short.
using InterruptHandler = void (*)(void* context);

/// All interrupts off, nothing pending, none attached. Once, before anything is attached.
void interrupts_initialize();

/// `handler(context)` serves interrupt `id` (a shared peripheral interrupt, 32 to 95) from now on.
void interrupts_attach(unsigned id, InterruptHandler handler, void* context);

}  // namespace vbar::boards::zynq7000
