#pragma once
// Requests to a debugger or an emulator (Arm semihosting, 2.0). Without either they have no effect: the request is an
// SVC instruction, and this image's own SVC handler answers those not handled elsewhere.

#include <cstddef>
#include <cstdint>
#include <span>

namespace vbar::boards::zynq7000 {

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

}  // namespace vbar::boards::zynq7000
