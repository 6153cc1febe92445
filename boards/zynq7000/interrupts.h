#pragma once
// The generic interrupt controller (PL390): handlers of shared interrupts.

namespace vbar::boards::zynq7000 {

/// Runs with interrupts masked, on the stack of the interrupted code. Must be short.
using InterruptHandler = void (*)(void* context);

/// All interrupts disabled, none pending, none attached. To be called once, before a handler is attached.
void interrupts_initialize();

/// `handler(context)` serves interrupt `id` (a shared peripheral interrupt, 32 to 95) from now on.
void interrupts_attach(unsigned id, InterruptHandler handler, void* context);

}  // namespace vbar::boards::zynq7000
