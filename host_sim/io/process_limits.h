#pragma once
// Limits of memory and processes for a program of the user's own, and the removal of what it leaves behind.

#include <cstdint>

#include <sys/resource.h>
#include <sys/types.h>

namespace vbar::io {

inline constexpr std::uint64_t kBytesPerGib = std::uint64_t{1} << 30;

/// Memory of a flight software, a sensor or a truth, unless the mission states another.
inline constexpr std::uint64_t kDefaultMemoryBytes = 8 * kBytesPerGib;

/// Limits the memory of this process and of those that it starts to `bytes` more than this one has now: an allocation
/// beyond fails. Nothing is limited in a program with address sanitizer, whose own memory is larger. Async-signal-safe.
/// False if the system refuses.
[[nodiscard]] bool limit_memory(std::uint64_t bytes);

/// waitpid for a child that leads a process group: once it has ended, the processes that remain in its group are
/// killed if `ends_group`, before its number can be that of another. `options`: 0 or WNOHANG. True if it has ended.
bool reap_leader(pid_t leader, int options, bool ends_group, int& status, rusage& usage);

/// Whether a process that used `usage` may have ended because of a limit of `bytes`.
[[nodiscard]] bool came_near(std::uint64_t bytes, const rusage& usage);

}  // namespace vbar::io
