#pragma once
// Where execution ends when it cannot go on: a line on the console, the exit code for a debugger or emulator, then
// rest.

#include "boards/zynq7000/semihosting.h"

namespace vbar::boards::zynq7000 {

/// As startup.S numbers them.
enum class FaultKind : std::uint32_t { kUndefined = 1, kPrefetchAbort = 2, kDataAbort = 3, kFastInterrupt = 4 };

/// Prints `reason` and stops for good. The board needs a reset afterwards.
[[noreturn]] void halt(const char* reason, ExitCode code);

}  // namespace vbar::boards::zynq7000
