#include "host_sim/io/process_limits.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

namespace vbar::io {
namespace {

/// Data and stack of this process, bytes; 0 if the system does not say.
std::uint64_t data_bytes() {
  std::array<char, 256> text{};
  const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  const ssize_t size = ::read(file, text.data(), text.size() - 1);
  (void)::close(file);
  if (size <= 0) return 0;
  constexpr int kDataField = 5;  // size, resident, shared, text, 0, data
  const char* at = text.data();
  char* end = nullptr;
  for (int field = 0; field < kDataField; ++field) {
    (void)std::strtoull(at, &end, 10);
    at = end;
  }
  return std::strtoull(at, &end, 10) * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

bool limit_memory([[maybe_unused]] std::uint64_t bytes) {
#ifdef __SANITIZE_ADDRESS__
  return true;
#else
  struct rlimit limit {};
  if (::getrlimit(RLIMIT_DATA, &limit) != 0) return false;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, data_bytes() + bytes);
  limit.rlim_max = limit.rlim_cur;  // the program cannot raise it again
  return ::setrlimit(RLIMIT_DATA, &limit) == 0;
#endif
}

bool reap_leader(pid_t leader, int options, bool ends_group, int& status, rusage& usage) {
  siginfo_t info{};
  int waited = -1;
  do {
    waited = ::waitid(P_PID, static_cast<id_t>(leader), &info, WEXITED | WNOWAIT | options);
  } while (waited < 0 && errno == EINTR);
  if (waited != 0 || info.si_pid != leader) return false;
  if (ends_group) (void)::kill(-leader, SIGKILL);
  pid_t reaped = -1;
  do {
    reaped = ::wait4(leader, &status, 0, &usage);
  } while (reaped < 0 && errno == EINTR);
  return reaped == leader;
}

bool came_near(std::uint64_t bytes, const rusage& usage) {
  constexpr std::uint64_t kKilobyte = 1024;
  return 2 * kKilobyte * static_cast<std::uint64_t>(usage.ru_maxrss) > bytes;
}

}  // namespace vbar::io
