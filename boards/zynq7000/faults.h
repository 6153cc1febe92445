#pragma once
// Fatal errors: a line on the console, the exit code for a debugger or emulator, then the board halts.

#include "boards/zynq7000/semihosting.h"

namespace vbar::boards::zynq7000 {

/// Kinds of faults, with the numbers of startup.S.
enum class FaultKind : std::uint32_t { kUndefined = 1, kPrefetchAbort = 2, kDataAbort = 3, kFastInterrupt = 4 };

/// Prints `reason` and halts. The board needs a reset afterwards.
[[noreturn]] void halt(const char* reason, ExitCode code);

}  // namespace vbar::boards::zynq7000
