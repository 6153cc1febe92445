#include "host_sim/io/child_process.h"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "host_sim/io/byte_channel.h"
#include "tests/support/sanitizers.h"

namespace vbar::io {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::AllOf;
using testing::HasSubstr;

constexpr seconds kLong{10};  // far more than a process needs to start or end, even on a loaded machine

/// A process that is neither gone nor a zombie.
bool is_alive(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string line;
  if (!std::getline(file, line)) return false;
  return line.at(line.rfind(')') + 2) != 'Z';
}

bool ends_within(pid_t pid, std::chrono::steady_clock::duration patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (is_alive(pid)) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(milliseconds(2));
  }
  return true;
}

TEST(ChildProcess, TellsExitStatusAndOutput) {
  ChildProcess child({"sh", "-c", "echo to output; echo to error >&2; exit 3"}, {});
  ASSERT_TRUE(child.wait_for_end(kLong));
  EXPECT_EQ(child.status_text(), "exit status 3");
  EXPECT_EQ(child.output_tail(), "to output\nto error\n");
  EXPECT_EQ(child.output_tail(9), "to error\n");
}

// A program that prints without end would take all memory.
TEST(ChildProcess, KeepsTheLastOutputOnly) {
  ChildProcess child({"sh", "-c", "head -c 300000000 /dev/zero; echo last"}, {});
  ASSERT_TRUE(child.wait_for_end(std::chrono::seconds(60)));
  EXPECT_TRUE(child.has_ended());
  EXPECT_EQ(child.output_tail(5), "last\n");
  std::size_t found = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code closed;  // the iterator's own descriptor
    if (!std::filesystem::read_symlink(entry.path(), closed).string().starts_with("/memfd:vbar child output")) continue;
    struct stat info {};
    ASSERT_EQ(::stat(entry.path().c_str(), &info), 0);
    EXPECT_LT(info.st_blocks * 512, 100'000'000);
    ++found;
  }
  EXPECT_EQ(found, 1U);
}

TEST(ChildProcess, LeavesNothingBehindThatItStarted) {
  ChildProcess child({"sh", "-c", "sleep 1000 & echo $!"}, {});
  ASSERT_TRUE(child.wait_for_end(kLong));
  EXPECT_TRUE(ends_within(std::stoi(child.output_tail()), kLong));
}

TEST(ChildProcess, LeavesNothingBehindInAnotherSession) {
  ChildProcess child({"sh", "-c", "setsid sh -c 'sleep 1000 & echo $!'"}, {});
  ASSERT_TRUE(child.wait_for_end(kLong));
  EXPECT_TRUE(ends_within(std::stoi(child.output_tail()), kLong));
  EXPECT_EQ(::waitid(P_ALL, 0, nullptr, WEXITED | WNOHANG | WNOWAIT), -1) << "a child or a zombie is left";
}

// A daemon's first process ends at once: its second one is the leader's until the leader ends.
TEST(ChildProcess, WhatALivingChildHasLeftLivesAsLongAsItself) {
  pid_t daemon = -1;
  {
    ChildProcess child({"sh", "-c", "setsid sh -c 'sleep 1000 & echo $!'; exec sleep 1000"}, {});
    while (child.output_tail().find('\n') == std::string::npos) std::this_thread::sleep_for(milliseconds(1));
    daemon = std::stoi(child.output_tail());
    ChildProcess other({"true"}, {});
    ASSERT_TRUE(other.wait_for_end(kLong));
    EXPECT_TRUE(is_alive(daemon));
  }
  EXPECT_FALSE(is_alive(daemon));
}

TEST(ChildProcess, EndsNoProcessThatItDidNotStart) {
  const pid_t foreign = ::fork();
  ASSERT_GE(foreign, 0);
  if (foreign == 0) {
    for (;;) ::pause();
  }
  {
    ChildProcess child({"true"}, {});
    ASSERT_TRUE(child.wait_for_end(kLong));
  }
  EXPECT_TRUE(is_alive(foreign));
  ::kill(foreign, SIGKILL);
  ::waitpid(foreign, nullptr, 0);
}

TEST(ChildProcess, AnAllocationBeyondItsMemoryFails) {
  if (vbar::test::kAddressSanitizer) GTEST_SKIP() << "memory is not limited in a program with address sanitizer";
  constexpr std::uint64_t kLimit = std::uint64_t{64} << 20;
  const auto doubled = [](std::uint64_t memory_bytes) {  // a text of 256 MB
    ChildProcess child({"sh", "-c", "x=x; i=0; while [ $i -lt 28 ]; do x=$x$x; i=$((i+1)); done; echo ${#x}"}, {},
                       memory_bytes);
    EXPECT_TRUE(child.wait_for_end(std::chrono::seconds(60)));
    return child.exit_status() == 0 ? std::string("done") : child.status_text();
  };
  EXPECT_EQ(doubled(0), "done");
  EXPECT_THAT(doubled(kLimit), HasSubstr("limit of its memory, 64 MiB"));
}

TEST(ChildProcess, TellsTheSignalThatKilledIt) {
  ChildProcess child({"sh", "-c", "kill -9 $$"}, {});
  ASSERT_TRUE(child.wait_for_end(kLong));
  EXPECT_EQ(child.status_text(), "killed by signal 9 (Killed)");
}

TEST(ChildProcess, RunsAFunctionInACopyOfThisProcess) {
  int seen = 0;
  const auto body = [&seen] {
    seen = 1;
    std::printf("to output\n");
    std::fprintf(stderr, "to error\n");
    return 3;
  };
  ChildProcess child(body, "a function");
  ASSERT_TRUE(child.wait_for_end(kLong));
  EXPECT_EQ(child.status_text(), "exit status 3");
  EXPECT_THAT(child.output_tail(), AllOf(HasSubstr("to output\n"), HasSubstr("to error\n")));
  EXPECT_EQ(child.program(), "a function");
  EXPECT_EQ(seen, 0) << "what the copy writes stays in the copy";
}

TEST(ChildProcess, OfAFunctionAnswersAnExceptionWithItsText) {
  ChildProcess child([]() -> int { throw std::runtime_error("no way"); }, "a function");
  ASSERT_TRUE(child.wait_for_end(kLong));
  EXPECT_EQ(child.status_text(), "exit status 127");
  EXPECT_EQ(child.output_tail(), "no way\n");
}

TEST(ChildProcess, OfAFunctionHasNoOtherDescriptorAndDoesNotRepeatWhatIsInBuffers) {
  const FileDescriptor other(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  std::printf("in the buffer of the parent");
  ChildProcess child([&other] { return ::fcntl(other.get(), F_GETFD) < 0 ? 0 : 1; }, "a function");
  ASSERT_TRUE(child.wait_for_end(kLong));
  EXPECT_EQ(child.exit_status(), 0) << "the descriptor is open";
  EXPECT_EQ(child.output_tail(), "");
}

TEST(ChildProcess, OfAFunctionThatDoesNotEndIsKilled) {
  pid_t pid = -1;
  {
    const auto body = [] {
      for (;;) ::pause();
      return 0;
    };
    ChildProcess child(body, "a function");
    pid = child.pid();
    EXPECT_FALSE(child.has_ended());
  }
  EXPECT_FALSE(is_alive(pid));
}

TEST(ChildProcess, ArgumentsReachTheProgramAsTheyAre) {
  ChildProcess child({"printf", "%s|", "a b", "$HOME", "*", ";exit"}, {});
  ASSERT_TRUE(child.wait_for_end(kLong));
  EXPECT_EQ(child.output_tail(), "a b|$HOME|*|;exit|");
}

TEST(ChildProcess, AMissingProgramIsAnErrorThatNamesIt) {
  try {
    ChildProcess child({"/nowhere/flight"}, {});
    FAIL() << "started";
  } catch (const std::system_error& error) {
    EXPECT_EQ(error.code(), std::errc::no_such_file_or_directory);
    EXPECT_THAT(error.what(), HasSubstr("/nowhere/flight"));
  }
}

TEST(ChildProcess, IsGoneAfterItsOwnerEvenIfItIgnoresSigterm) {
  pid_t pid = -1;
  {
    ChildProcess child({"sh", "-c", "trap '' TERM; echo ready; while :; do sleep 1; done"}, {});
    pid = child.pid();
    while (child.output_tail().empty()) std::this_thread::sleep_for(milliseconds(1));
    EXPECT_TRUE(is_alive(pid));
  }
  EXPECT_FALSE(is_alive(pid));
}

TEST(ChildProcess, IsGoneAfterAnException) {
  pid_t pid = -1;
  try {
    ChildProcess child({"sleep", "1000"}, {});
    pid = child.pid();
    throw std::runtime_error("in mid-run");
  } catch (const std::runtime_error&) {
  }
  EXPECT_FALSE(is_alive(pid));
  EXPECT_EQ(::waitpid(pid, nullptr, WNOHANG), -1);  // reaped already
}

TEST(ChildProcess, TakesItsOwnChildrenAlong) {
  pid_t grandchild = -1;
  {
    ChildProcess child({"sh", "-c", "sleep 1000 & echo $!; wait"}, {});
    while (child.output_tail().find('\n') == std::string::npos) std::this_thread::sleep_for(milliseconds(1));
    grandchild = std::stoi(child.output_tail());
    EXPECT_TRUE(is_alive(grandchild));
  }
  EXPECT_TRUE(ends_within(grandchild, kLong));
}

// The test's program plays the program that dies: a copy of it starts the child and is killed without a chance to clean
// up.
TEST(ChildProcess, DiesWithTheProgramThatStartedIt) {
  int pipe_ends[2];
  ASSERT_EQ(::pipe(pipe_ends), 0);
  const pid_t program = ::fork();
  ASSERT_GE(program, 0);
  if (program == 0) {
    const ChildProcess child({"sleep", "1000"}, {});
    const pid_t pid = child.pid();
    (void)!::write(pipe_ends[1], &pid, sizeof pid);
    ::pause();
  }
  pid_t child = -1;
  ASSERT_EQ(::read(pipe_ends[0], &child, sizeof child), static_cast<ssize_t>(sizeof child));
  EXPECT_TRUE(is_alive(child));
  ::kill(program, SIGKILL);
  ::waitpid(program, nullptr, 0);
  EXPECT_TRUE(ends_within(child, kLong));
  ::close(pipe_ends[0]);
  ::close(pipe_ends[1]);
}

TEST(ChildProcess, InheritsWhatItIsGivenAndNothingElse) {
  const FileDescriptor not_for_it(::open("/dev/zero", O_RDONLY));  // deliberately not close-on-exec
  auto [ours, theirs] = make_socket_pair();
  std::vector<FileDescriptor> inherited;
  inherited.push_back(std::move(theirs));
  ChildProcess child({"sh", "-c", "cat <&3 >&3; ls -1 /proc/self/fd"}, std::move(inherited));
  ASSERT_EQ(::write(ours.get(), "echo", 4), 4);
  char answer[4] = {};
  ASSERT_EQ(::read(ours.get(), answer, 4), 4);
  EXPECT_EQ(std::string(answer, 4), "echo");
  ::shutdown(ours.get(), SHUT_WR);
  ASSERT_TRUE(child.wait_for_end(kLong));
  EXPECT_EQ(child.output_tail(), "0\n1\n2\n3\n4\n");  // 4 is the directory that ls reads
}

TEST(ChildProcess, RunsInAProcessGroupOfItsOwn) {
  ChildProcess child({"sleep", "1000"}, {});
  EXPECT_EQ(::getpgid(child.pid()), child.pid());
}

}  // namespace
}  // namespace vbar::io
