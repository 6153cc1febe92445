#pragma once
// Requests to a debugger or an emulator (Arm semihosting, 2.0). Where nobody listens they do nothing: the request is an
// SVC instruction, and this image's own SVC handler answers what nobody else caught.

#include <cstddef>
#include <cstdint>
#include <span>

namespace vbar::boards::zynq7000 {

/// How a run of this image ended, as a process's exit status.
enum class ExitCode : std::uint32_t {
  kDone = 0,
  kSelfTestFailed = 1,
  kHeapCalled = 99,
  kFault = 100,  ///< plus FaultKind
  kAborted = 110,
};

/// Ends the emulator, or hands over to the debugger. Returns where there is neither.
void semihosting_exit(std::uint32_t code);

/// Copies the command line, zero-terminated, to `text`. False where there is none or it does not fit.
bool semihosting_command_line(std::span<char> text);

}  // namespace vbar::boards::zynq7000
