#pragma once
// Fatal errors: a line on the console, the exit code for a debugger or emulator, then the board halts.

#include <cstddef>
#include <cstdint>
#include <span>

namespace vbar::boards::zynq7000 {

// Requests to a debugger or an emulator (Arm semihosting, 2.0). Without either they have no effect: the request is an
// SVC instruction, and this image's own SVC handler answers those not handled elsewhere.

/// Result of a run of this image, as exit status of a process.
enum class ExitCode : std::uint32_t {
  kDone = 0,
  kSelfTestFailed = 1,
  kHeapCalled = 99,
  kFault = 100,  ///< plus FaultKind
  kAborted = 110,
};

/// Ends the emulator, or stops at the debugger. Returns if there is neither.
void semihosting_exit(std::uint32_t code);

/// Copies the command line, zero-terminated, to `text`. Returns false if there is none or it does not fit.
bool semihosting_command_line(std::span<char> text);

/// Kinds of faults, with the numbers of startup.S.
enum class FaultKind : std::uint32_t { kUndefined = 1, kPrefetchAbort = 2, kDataAbort = 3, kFastInterrupt = 4 };

/// Prints `reason` and halts. The board needs a reset afterwards.
[[noreturn]] void halt(const char* reason, ExitCode code);

}  // namespace vbar::boards::zynq7000
