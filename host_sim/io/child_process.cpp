#include "host_sim/io/child_process.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <linux/close_range.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "host_sim/io/address_sanitizer.h"
#include "host_sim/io/process_tree.h"

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

bool limit_memory(std::uint64_t bytes) {
  if (kAddressSanitizer) return true;
  struct rlimit limit {};
  if (::getrlimit(RLIMIT_DATA, &limit) != 0) return false;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, data_bytes() + bytes);
  limit.rlim_max = limit.rlim_cur;  // the program cannot raise it again
  return ::setrlimit(RLIMIT_DATA, &limit) == 0;
}

bool came_near(std::uint64_t bytes, const rusage& usage) {
  constexpr std::uint64_t kKilobyte = 1024;
  return 2 * kKilobyte * static_cast<std::uint64_t>(usage.ru_maxrss) > bytes;
}

namespace {

constexpr int kFirstInherited = 3;
constexpr std::chrono::milliseconds kExitPollPeriod{2};

[[noreturn]] void throw_errno(const std::string& what, int error) {
  throw std::system_error(error, std::generic_category(), what);
}

/// Data of the child between fork and exec, prepared before the fork: only async-signal-safe calls are allowed
/// there, unless this process has a single thread.
struct ExecPlan {
  std::vector<char*> arguments;
  std::vector<int> descriptors;  ///< to become 0, 1, 2, 3, ...
  int report_errno_to = -1;
  pid_t parent = -1;
  std::uint64_t memory_bytes = 0;
};

/// Moves the planned descriptors to 0, 1, 2, ... and closes the rest, except the one that reports errors
/// (close-on-exec).
bool arrange_descriptors(ExecPlan& plan) {
  const int count = static_cast<int>(plan.descriptors.size());
  // First away from the numbers that they may occupy, then to the planned ones; dup2 clears close-on-exec.
  for (int& fd : plan.descriptors) {
    fd = ::fcntl(fd, F_DUPFD_CLOEXEC, count + 1);
    if (fd < 0) return false;
  }
  const int report = ::fcntl(plan.report_errno_to, F_DUPFD_CLOEXEC, count + 1);
  if (report < 0) return false;
  for (int i = 0; i < count; ++i) {
    if (::dup2(plan.descriptors[static_cast<std::size_t>(i)], i) < 0) return false;
  }
  if (::dup3(report, count, O_CLOEXEC) < 0) return false;
  plan.report_errno_to = count;
  // A kernel without close_range still closes descriptors opened close-on-exec, as all those of this library.
  (void)::close_range(static_cast<unsigned>(count) + 1U, ~0U, 0);
  return true;
}

/// Runs a function in the copy of this process; standard output and error are its own by now.
[[noreturn]] void run(const std::function<int()>& body) {
  int status = 127;
  try {
    status = body();
  } catch (const std::exception& error) {
    (void)std::fprintf(stderr, "%s\n", error.what());
  }
  (void)std::fflush(nullptr);
  ::_exit(status);
}

[[noreturn]] void become(ExecPlan& plan, const std::function<int()>& body) {
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const bool ready = ::setpgid(0, 0) == 0 && ::prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 && arrange_descriptors(plan);
  // The parent may have died before the death signal was asked for.
  if (::getppid() != plan.parent) ::_exit(127);
  if (ready && plan.memory_bytes > 0) (void)limit_memory(plan.memory_bytes);  // a lower one may hold already
  if (ready && body) {
    (void)::close(plan.report_errno_to);
    run(body);
  }
  if (ready) ::execvp(plan.arguments[0], plan.arguments.data());
  const int error = errno;
  (void)!::write(plan.report_errno_to, &error, sizeof error);
  ::_exit(127);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& arguments, std::vector<FileDescriptor> inherited,
                           std::uint64_t memory_bytes)
    : memory_bytes_(memory_bytes) {
  if (arguments.empty()) throw std::invalid_argument("a child process needs a program");
  program_ = arguments[0];
  start(arguments, inherited, nullptr);
}

ChildProcess::ChildProcess(const std::function<int()>& body, std::string name) : program_(std::move(name)) {
  (void)std::fflush(nullptr);  // what is in the buffers would be written by both processes
  start({}, {}, body);
}

void ChildProcess::start(const std::vector<std::string>& arguments, const std::vector<FileDescriptor>& inherited,
                         const std::function<int()>& body) {
  // A memory file rather than a pipe: the child can never block on it and no reader is required.
  output_ = FileDescriptor(::memfd_create("vbar child output", MFD_CLOEXEC));
  FileDescriptor null(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  int pipe_ends[2];
  if (output_.get() < 0 || null.get() < 0 || ::pipe2(pipe_ends, O_CLOEXEC) != 0)
    throw_errno("starting " + program_, errno);
  FileDescriptor error_reader(pipe_ends[0]);
  FileDescriptor error_writer(pipe_ends[1]);

  std::vector<std::string> storage = arguments;
  ExecPlan plan;
  for (std::string& argument : storage) plan.arguments.push_back(argument.data());
  plan.arguments.push_back(nullptr);
  plan.descriptors = {null.get(), output_.get(), output_.get()};
  static_assert(kFirstInherited == STDERR_FILENO + 1);
  for (const FileDescriptor& fd : inherited) plan.descriptors.push_back(fd.get());
  plan.report_errno_to = error_writer.get();
  plan.parent = ::getpid();
  plan.memory_bytes = memory_bytes_;

  pid_ = fork_leader();
  if (pid_ < 0) throw_errno("starting " + program_, errno);
  if (pid_ == 0) become(plan, body);

  // Also here, so that the group exists in either order of execution.
  (void)::setpgid(pid_, pid_);
  error_writer.reset();
  int error = 0;
  ssize_t got = 0;
  do {
    got = ::read(error_reader.get(), &error, sizeof error);
  } while (got < 0 && errno == EINTR);
  if (got > 0) {
    terminate(std::chrono::milliseconds(0));
    throw_errno("starting " + program_, error);
  }
}

ChildProcess::~ChildProcess() {
  terminate(std::chrono::milliseconds(500));
}

namespace {

/// Gives back the memory of all but the last output of a program that prints without end.
void discard_old_output(int file) {
  constexpr blkcnt_t kBlocksMax = (blkcnt_t{64} << 20) / 512;
  constexpr off_t kKept = off_t{1} << 20;
  struct stat info {};
  if (::fstat(file, &info) != 0 || info.st_blocks <= kBlocksMax || info.st_size <= kKept) return;
  (void)::fallocate(file, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0, info.st_size - kKept);
}

}  // namespace

bool ChildProcess::has_ended() {
  discard_old_output(output_.get());
  return wait_status_.has_value() || reap(WNOHANG);
}

bool ChildProcess::reap(int options) {
  int status = 0;
  struct rusage usage {};
  if (!reap_leader(pid_, options, !keeps_tree_, status, usage)) return false;
  wait_status_ = status;
  came_near_limit_ = memory_bytes_ > 0 && came_near(memory_bytes_, usage);
  for (const timeval& time : {usage.ru_utime, usage.ru_stime})
    processor_time_s_ += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  return true;
}

bool ChildProcess::wait_for_end(std::chrono::milliseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!has_ended()) {
    if (std::chrono::steady_clock::now() >= deadline) return false;
    std::this_thread::sleep_for(kExitPollPeriod);
  }
  return true;
}

void ChildProcess::terminate(std::chrono::milliseconds patience) {
  if (has_ended()) return;
  if (patience.count() > 0) {
    (void)::kill(-pid_, SIGTERM);
    if (wait_for_end(patience)) return;
  }
  (void)::kill(-pid_, SIGKILL);
  (void)reap(0);
}

std::optional<int> ChildProcess::exit_status() const {
  return wait_status_ && WIFEXITED(*wait_status_) ? std::optional(WEXITSTATUS(*wait_status_)) : std::nullopt;
}

std::optional<int> ChildProcess::killed_by() const {
  return wait_status_ && WIFSIGNALED(*wait_status_) ? std::optional(WTERMSIG(*wait_status_)) : std::nullopt;
}

std::string ChildProcess::status_text() const {
  if (!wait_status_) return "running";
  if (WIFSIGNALED(*wait_status_)) {
    const int signal = WTERMSIG(*wait_status_);
    return "killed by signal " + std::to_string(signal) + " (" + ::strsignal(signal) + ")" + memory_text();
  }
  return "exit status " + std::to_string(WEXITSTATUS(*wait_status_)) + memory_text();
}

std::string ChildProcess::memory_text() const {
  if (!came_near_limit_) return "";
  return "; it came near the limit of its memory, " + std::to_string(memory_bytes_ >> 20) + " MiB";
}

std::string ChildProcess::output_tail(std::size_t limit) const {
  struct stat info {};
  if (::fstat(output_.get(), &info) != 0) return {};
  const auto size = static_cast<std::size_t>(info.st_size);
  std::string text(std::min(size, limit), '\0');
  const ssize_t got = ::pread(output_.get(), text.data(), text.size(), static_cast<off_t>(size - text.size()));
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  return text;
}

}  // namespace vbar::io
