#include "pil_bridge/guarded_process.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <optional>
#include <utility>

#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "host_sim/io/file_descriptor.h"
#include "host_sim/io/process_limits.h"

namespace vbar::pil {
namespace {

using Clock = std::chrono::steady_clock;
using Bytes = std::vector<std::uint8_t>;

constexpr std::chrono::milliseconds kAfterSignal{1000};
constexpr Clock::time_point kNever = Clock::time_point::max();

template <class Number>
void put(Bytes& to, Number number) {
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(&number);
  to.insert(to.end(), bytes, bytes + sizeof number);
}

void put(Bytes& to, std::span<const Packet> packets) {
  put(to, static_cast<std::uint32_t>(packets.size()));
  for (const Packet& packet : packets) {
    put(to, static_cast<std::uint32_t>(packet.size()));
    to.insert(to.end(), packet.begin(), packet.end());
  }
}

/// Takes apart what put() wrote; both ends are this program.
class Reader {
 public:
  explicit Reader(const Bytes& bytes) : rest_(bytes) {}

  template <class Number>
  Number number() {
    Number value{};
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  std::vector<Packet> packets() {
    std::vector<Packet> all(number<std::uint32_t>());
    for (Packet& packet : all) {
      const auto bytes = take(number<std::uint32_t>());
      packet.assign(bytes.begin(), bytes.end());
    }
    return all;
  }
  std::string text() { return {rest_.begin(), rest_.end()}; }

 private:
  std::span<const std::uint8_t> take(std::size_t size) {
    if (size > rest_.size()) throw FlightComputerError("the child process sent a message that is cut short");
    const auto taken = rest_.first(size);
    rest_ = rest_.subspan(size);
    return taken;
  }
  std::span<const std::uint8_t> rest_;
};

enum class Transfer { kDone, kGone, kLate };

/// Sends or receives all of `bytes`, until `deadline`, which a signal to this process brings forward.
template <class Byte, class Call>
Transfer transfer(int socket, std::span<Byte> bytes, short event, Clock::time_point& deadline, const Call& call) {
  while (!bytes.empty()) {
    const ssize_t size = call(bytes);
    if (size > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(size));
      continue;
    }
    if (size == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) return Transfer::kGone;
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return Transfer::kLate;
    pollfd request{.fd = socket, .events = event, .revents = 0};
    if (::poll(&request, 1, static_cast<int>(std::min<std::int64_t>(left, 1'000'000))) < 0 && errno == EINTR &&
        deadline != kNever)
      deadline = std::min(deadline, Clock::now() + kAfterSignal);
  }
  return Transfer::kDone;
}

/// A message is its size, then its bytes.
Transfer send_message(int socket, const Bytes& message, Clock::time_point& deadline) {
  Bytes framed;
  put(framed, static_cast<std::uint32_t>(message.size()));
  framed.insert(framed.end(), message.begin(), message.end());
  return transfer(socket, std::span<const std::uint8_t>(framed), POLLOUT, deadline, [socket](auto bytes) {
    return ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  });
}

Transfer receive_message(int socket, Bytes& message, Clock::time_point& deadline) {
  const auto take = [socket](auto bytes) { return ::recv(socket, bytes.data(), bytes.size(), MSG_DONTWAIT); };
  std::uint32_t size = 0;
  const std::span header(reinterpret_cast<std::uint8_t*>(&size), sizeof size);
  const Transfer first = transfer(socket, header, POLLIN, deadline, take);
  if (first != Transfer::kDone) return first;
  message.resize(size);
  return transfer(socket, std::span(message), POLLIN, deadline, take);
}

enum class Answer : std::uint8_t { kDone, kError };

Bytes error_message(const std::exception& error) {
  Bytes message;
  put(message, Answer::kError);
  const std::string_view text = error.what();
  message.insert(message.end(), text.begin(), text.end());
  return message;
}

/// The child: steps until the socket closes. Signals of the terminal are the parent's affair.
void serve(int socket, const std::function<std::unique_ptr<FlightComputer>()>& make) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) std::signal(number, SIG_IGN);
  // A crash has to show as one, whatever handlers this program has.
  for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) std::signal(number, SIG_DFL);
  Clock::time_point never = kNever;
  try {
    const std::unique_ptr<FlightComputer> computer = make();
    Bytes hello, request;
    put(hello, Answer::kDone);
    const std::string description = computer->description();
    hello.insert(hello.end(), description.begin(), description.end());
    static_cast<void>(send_message(socket, hello, never));
    while (receive_message(socket, request, never) == Transfer::kDone) {
      Reader reader(request);
      const auto step = reader.number<std::uint32_t>();
      const StepResult result = computer->step(step, reader.packets());
      Bytes answer;
      put(answer, Answer::kDone);
      put(answer, result.compute_wall_s);
      put(answer, result.trouble);
      put(answer, std::span<const Packet>(result.packets));
      static_cast<void>(send_message(socket, answer, never));
    }
  } catch (const std::exception& error) {
    static_cast<void>(send_message(socket, error_message(error), never));
  }
}

class Guarded final : public FlightComputer {
 public:
  Guarded(const std::function<std::unique_ptr<FlightComputer>()>& make, const std::string& name,
          std::chrono::milliseconds step_limit, std::uint64_t memory_bytes)
      : name_(name), step_limit_(step_limit), memory_bytes_(memory_bytes) {
    int ends[2] = {-1, -1};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) fail("cannot be started", errno);
    io::FileDescriptor ours(ends[0]), theirs(ends[1]);
    std::fflush(nullptr);  // or the child would write again what waits in this process's buffers
    const pid_t parent = ::getpid();
    child_ = ::fork();
    if (child_ < 0) fail("cannot be started", errno);
    if (child_ == 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (::getppid() != parent || ::setpgid(0, 0) != 0) ::_exit(1);
      if (memory_bytes > 0 && !io::limit_memory(memory_bytes)) ::_exit(1);
      ours.reset();
      serve(theirs.get(), make);
      std::fflush(stdout);
      ::_exit(0);
    }
    static_cast<void>(::setpgid(child_, child_));  // also here, so that the group exists in either order
    socket_ = std::move(ours);
    theirs.reset();
    const Bytes hello = await("while it was loaded");
    description_.assign(hello.begin() + 1, hello.end());
  }
  ~Guarded() override { stop(SIGKILL); }

  StepResult step(std::uint32_t step, std::span<const Packet> packets) override {
    if (child_ <= 0) throw FlightComputerError(name_ + " has ended");
    const std::string where = "at step " + std::to_string(step);
    Bytes request;
    put(request, step);
    put(request, packets);
    Clock::time_point deadline = Clock::now() + step_limit_;
    if (const Transfer sent = send_message(socket_.get(), request, deadline); sent != Transfer::kDone)
      explain(sent, where);
    const Bytes answer = await(where);
    Reader reader(answer);
    static_cast<void>(reader.number<Answer>());
    StepResult result;
    result.compute_wall_s = reader.number<double>();
    result.trouble = reader.number<StepTrouble>();
    result.packets = reader.packets();
    return result;
  }

  [[nodiscard]] LinkStatistics statistics() const override { return {}; }
  [[nodiscard]] std::string description() const override { return description_; }
  void close() override {
    socket_.reset();
    stop(0);
  }

 private:
  [[noreturn]] void fail(const std::string& what, int error) const {
    throw FlightComputerError(name_ + ": " + what + ": " + std::strerror(error));
  }

  /// The child's next message, which is not an error.
  Bytes await(const std::string& where) {
    Clock::time_point deadline = Clock::now() + step_limit_;
    Bytes message;
    const Transfer received = receive_message(socket_.get(), message, deadline);
    if (received != Transfer::kDone) explain(received, where);
    Reader reader(message);
    if (reader.number<Answer>() == Answer::kDone) return message;
    const std::string text = reader.text();
    stop(SIGKILL);
    throw FlightComputerError(text);
  }

  [[noreturn]] void explain(Transfer transfer, const std::string& where) {
    if (transfer == Transfer::kLate) {
      stop(SIGKILL);
      throw FlightComputerError(name_ + " did not return " + where + " in time, and was stopped");
    }
    const int status = stop(0);
    const std::string memory =
        memory_bytes_ > 0 && io::came_near(memory_bytes_, usage_)
            ? "; it came near the limit of its memory, " + std::to_string(memory_bytes_ >> 20) + " MiB"
            : "";
    if (WIFSIGNALED(status))
      throw FlightComputerError(name_ + " crashed " + where + ": " + ::strsignal(WTERMSIG(status)) + memory);
    throw FlightComputerError(name_ + " ended its process " + where + ", with exit code " +
                              std::to_string(WEXITSTATUS(status)) + memory);
  }

  /// Ends the child, by a signal unless that is 0, and by force if it takes longer than the limit of a step.
  int stop(int signal) {
    int status = 0;
    if (child_ <= 0) return status;
    if (signal != 0) ::kill(-child_, signal);
    const Clock::time_point deadline = Clock::now() + std::min<std::chrono::milliseconds>(step_limit_, kAfterSignal);
    while (!io::reap_leader(child_, WNOHANG, true, status, usage_)) {
      if (Clock::now() > deadline) ::kill(-child_, SIGKILL);
      ::usleep(1000);
    }
    child_ = -1;
    return status;
  }

  std::string name_;
  std::chrono::milliseconds step_limit_;
  std::uint64_t memory_bytes_;
  rusage usage_{};
  io::FileDescriptor socket_;
  pid_t child_ = -1;
  std::string description_;
};

}  // namespace

std::unique_ptr<FlightComputer> make_guarded(const std::function<std::unique_ptr<FlightComputer>()>& make,
                                             const std::string& name, std::chrono::milliseconds step_limit,
                                             std::uint64_t memory_bytes) {
  return std::make_unique<Guarded>(make, name, step_limit, memory_bytes);
}

}  // namespace vbar::pil
