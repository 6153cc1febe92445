#pragma once
// Limits of memory and processes for a program of the user's own, and the removal of what it leaves behind.

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <sys/resource.h>
#include <sys/types.h>

#include "host_sim/io/file_descriptor.h"

namespace vbar::io {

inline constexpr std::uint64_t kBytesPerGib = std::uint64_t{1} << 30;

/// Memory of a flight software, a sensor or a truth, unless the mission states another.
inline constexpr std::uint64_t kDefaultMemoryBytes = 8 * kBytesPerGib;

/// Limits the memory of this process and of those that it starts to `bytes` more than this one has now: an allocation
/// beyond fails. Nothing is limited in a program with address sanitizer, whose own memory is larger. Async-signal-safe.
/// False if the system refuses.
[[nodiscard]] bool limit_memory(std::uint64_t bytes);

/// Whether a process that used `usage` may have ended because of a limit of `bytes`.
[[nodiscard]] bool came_near(std::uint64_t bytes, const rusage& usage);

// A child process that does not outlive its owner: it is ended and reaped by its owner's destructor, also while an
// exception unwinds, and by the kernel if this program dies first. What it has started and left behind is ended with it
// (process_tree.h) unless it is to be kept.

class ChildProcess {
 public:
  /// Starts `arguments[0]` (looked up in PATH if it has no slash) without a shell, in a process group of its own. It
  /// finds `inherited[i]` as file descriptor 3 + i, nothing on its standard input, and no other descriptor of this
  /// program; its standard output and error are kept for `output_tail`.
  ///
  /// The kernel kills the child when the thread that called this ends: call it from a thread that outlives the child.
  /// Throws std::system_error if the program cannot be started.
  ///
  /// `memory_bytes`: most memory of the program and of each that it starts (limit_memory); 0: no limit.
  ChildProcess(const std::vector<std::string>& arguments, std::vector<FileDescriptor> inherited,
               std::uint64_t memory_bytes = 0);

  /// Starts a copy of this process that runs `body`, whose result is its exit status, in place of a program: the
  /// start costs no loading of libraries. An exception that leaves `body` is printed, and the status is 127. To be
  /// called while this process has no other thread. `name` stands for the program in messages.
  ChildProcess(const std::function<int()>& body, std::string name);

  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Lets the processes live on that the child leaves behind when it ends by itself, as those of a shell's "&".
  void keep_processes_left_behind() { keeps_tree_ = true; }

  /// Returns true once the child has ended by itself or has been ended.
  bool has_ended();

  /// Waits for the child to end by itself; true if it did.
  bool wait_for_end(std::chrono::milliseconds patience);

  /// Ends the child's process group: SIGTERM first, SIGKILL for processes that remain after `patience`. Returns when it
  /// is reaped.
  void terminate(std::chrono::milliseconds patience);

  /// Returns the status of a child that ended by itself; empty while it runs or if a signal killed it.
  [[nodiscard]] std::optional<int> exit_status() const;

  /// The signal that killed the child; empty of one that runs or ended by itself.
  [[nodiscard]] std::optional<int> killed_by() const;

  /// Processor time of the child and of its reaped children, s; 0 while it runs.
  [[nodiscard]] double processor_time_s() const { return processor_time_s_; }

  /// "exit status 3", "killed by signal 9 (Killed)"; "running". Names the limit of its memory if it came near that.
  [[nodiscard]] std::string status_text() const;

  /// The last bytes of the child's standard output and error, at most `limit`.
  [[nodiscard]] std::string output_tail(std::size_t limit = 2000) const;

  [[nodiscard]] pid_t pid() const { return pid_; }
  [[nodiscard]] const std::string& program() const { return program_; }

 private:
  std::string program_;
  FileDescriptor output_;
  pid_t pid_ = -1;
  std::optional<int> wait_status_;
  double processor_time_s_ = 0.0;
  std::uint64_t memory_bytes_ = 0;  ///< limit; 0: none
  bool keeps_tree_ = false;
  bool came_near_limit_ = false;

  void start(const std::vector<std::string>& arguments, const std::vector<FileDescriptor>& inherited,
             const std::function<int()>& body);
  bool reap(int options);
  [[nodiscard]] std::string memory_text() const;
};

}  // namespace vbar::io
