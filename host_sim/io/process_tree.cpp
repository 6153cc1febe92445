#include "host_sim/io/process_tree.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <dirent.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace vbar::io {

namespace {

struct Process {
  pid_t parent = -1;
  pid_t group = -1;
};

/// Reads parent and process group in /proc/PID/stat; those of a process that is gone are -1.
Process process_of(const char* pid) {
  Process process;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(
      std::fopen((std::string("/proc/") + pid + "/stat").c_str(), "re"), &std::fclose);
  std::array<char, 256> line{};
  if (file == nullptr || std::fgets(line.data(), line.size(), file.get()) == nullptr) return process;
  const char* const name_end = std::strrchr(line.data(), ')');  // the name may hold blanks and brackets
  if (name_end != nullptr) (void)std::sscanf(name_end, ") %*c %d %d", &process.parent, &process.group);
  return process;
}

/// Lists the children of this process that it has not forked: they are in other groups than its own, and are not
/// leaders.
std::vector<pid_t> orphans_of(const std::vector<pid_t>& known) {
  std::vector<pid_t> found;
  const std::unique_ptr<DIR, int (*)(DIR*)> folder(::opendir("/proc"), &::closedir);
  if (folder == nullptr) return found;
  const pid_t own = ::getpid();
  const pid_t own_group = ::getpgrp();
  while (const dirent* const entry = ::readdir(folder.get())) {
    const auto pid = static_cast<pid_t>(std::strtol(entry->d_name, nullptr, 10));
    if (pid <= 0) continue;
    const Process process = process_of(entry->d_name);
    if (process.parent == own && process.group != own_group && std::ranges::find(known, pid) == known.end())
      found.push_back(pid);
  }
  return found;
}

/// The leaders that this process has not reaped, and the children that it had before the first of them. The lock is
/// held during a fork, so that no leader is taken for an orphan before it is listed.
struct Leaders {
  std::mutex lock;
  std::vector<pid_t> known = orphans_of({});
  bool keeps_orphans = false;
};

Leaders& leaders() {
  static Leaders the_leaders;
  return the_leaders;
}

bool has_children() {
  siginfo_t info{};
  return ::waitid(P_ALL, 0, &info, WEXITED | WNOHANG | WNOWAIT) == 0 || errno != ECHILD;
}

/// Kills and reaps what dead leaders have left. Children of an orphan become orphans with its end: the number of rounds
/// limits how long a program that forks without end can keep this one.
void end_orphans(const std::vector<pid_t>& known) {
  constexpr int kRoundsMax = 1000;
  for (int round = 0; round < kRoundsMax && has_children(); ++round) {
    const std::vector<pid_t> orphans = orphans_of(known);
    if (orphans.empty()) return;
    for (const pid_t orphan : orphans) (void)::kill(orphan, SIGKILL);
    for (const pid_t orphan : orphans)
      while (::waitpid(orphan, nullptr, 0) < 0 && errno == EINTR) {
      }
  }
}

}  // namespace

pid_t fork_leader() {
  Leaders& all = leaders();
  const std::lock_guard hold(all.lock);
  if (!all.keeps_orphans) (void)::prctl(PR_SET_CHILD_SUBREAPER, 1);
  const pid_t pid = ::fork();
  if (pid > 0) all.known.push_back(pid);
  if (pid == 0) (void)::prctl(PR_SET_CHILD_SUBREAPER, 1);
  return pid;
}

bool reap_leader(pid_t leader, int options, bool ends_tree, int& status, rusage& usage) {
  siginfo_t info{};
  int waited = -1;
  do {
    waited = ::waitid(P_PID, static_cast<id_t>(leader), &info, WEXITED | WNOWAIT | options);
  } while (waited < 0 && errno == EINTR);
  if (waited != 0 || info.si_pid != leader) return false;
  if (ends_tree) (void)::kill(-leader, SIGKILL);
  pid_t reaped = -1;
  do {
    reaped = ::wait4(leader, &status, 0, &usage);
  } while (reaped < 0 && errno == EINTR);
  Leaders& all = leaders();
  const std::lock_guard hold(all.lock);
  std::erase(all.known, leader);
  if (!ends_tree) {
    all.keeps_orphans = true;
    (void)::prctl(PR_SET_CHILD_SUBREAPER, 0);
  }
  if (!all.keeps_orphans) end_orphans(all.known);
  return reaped == leader;
}

}  // namespace vbar::io
