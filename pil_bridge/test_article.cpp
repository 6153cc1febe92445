#include "pil_bridge/test_article.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <optional>
#include <utility>

#include <dlfcn.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "boards/common/outbox.h"
#include "fsw/packets/messages.h"
#include "host_sim/io/child_process.h"
#include "host_sim/io/file_descriptor.h"
#include "host_sim/io/process_tree.h"
#include "pil_bridge/flight_computer.h"
#include "pil_bridge/qemu.h"

namespace vbar::pil {

namespace {

struct LoadedArticle {
  explicit LoadedArticle(void* library) : handle(library) {}
  LoadedArticle(const LoadedArticle&) = delete;
  LoadedArticle& operator=(const LoadedArticle&) = delete;
  ~LoadedArticle() { ::dlclose(handle); }

  void* handle;
  TestArticle functions;
};

template <class Function>
void resolve(const std::string& path, void* handle, const char* symbol, Function& function) {
  function = reinterpret_cast<Function>(::dlsym(handle, symbol));
  if (function == nullptr) {
    throw FlightComputerError("flight_computer.library '" + path + "' has no function " + symbol +
                              " (fsw/messaging/vbar_gnc.h lists what it needs)");
  }
}

}  // namespace

std::string library_file(const std::string& library) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (library.find('/') != std::string::npos || library.ends_with(".so") || fs::exists(library, error)) return library;
  const std::string name = "lib" + library + ".so";
  return beside_program("../lib/vbar/" + name, name);
}

std::shared_ptr<const TestArticle> load_test_article(const std::string& library) {
  const std::string path = library_file(library);
  // With a slash in it, so that the loader takes the file named and does not search its own directories.
  const std::string file = std::filesystem::absolute(path).string();
  void* const handle = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* const reason = ::dlerror();
    throw FlightComputerError("flight_computer.library '" + path +
                              "' cannot be loaded: " + (reason != nullptr ? reason : "unknown reason"));
  }
  const auto article = std::make_shared<LoadedArticle>(handle);
  TestArticle& functions = article->functions;
  resolve(path, handle, "vbar_gnc_abi_version", functions.abi_version);
  resolve(path, handle, "vbar_gnc_name", functions.name);
  resolve(path, handle, "vbar_gnc_state_size", functions.state_size);
  resolve(path, handle, "vbar_gnc_state_alignment", functions.state_alignment);
  resolve(path, handle, "vbar_gnc_init", functions.init);
  resolve(path, handle, "vbar_gnc_set_sink", functions.set_sink);
  resolve(path, handle, "vbar_gnc_receive", functions.receive);
  resolve(path, handle, "vbar_gnc_step", functions.step);
  // Optional: make_in_process states its absence.
  functions.authenticate = reinterpret_cast<decltype(functions.authenticate)>(::dlsym(handle, "vbar_gnc_authenticate"));
  const std::int32_t version = functions.abi_version();
  if (version < VBAR_GNC_ABI_VERSION_MIN || version > VBAR_GNC_ABI_VERSION) {
    throw FlightComputerError("flight_computer.library '" + path + "' was built for version " +
                              std::to_string(version) + " of the test-article interface, this program for " +
                              std::to_string(VBAR_GNC_ABI_VERSION));
  }
  return {article, &functions};
}

namespace {

constexpr std::size_t kStateBytesMax = std::size_t{1} << 30;
constexpr std::size_t kStateAlignmentMax = 4096;

/// The article; throws FlightComputerError unless it has a name and asks for a state that there can be.
std::shared_ptr<const TestArticle> checked(std::shared_ptr<const TestArticle> article) {
  if (article->name() == nullptr)
    throw FlightComputerError(
        "the flight software has no name (vbar_gnc_name returned a null pointer); accepted: a text");
  const std::size_t size = article->state_size(), alignment = article->state_alignment();
  const std::string name = "the flight software '" + std::string(article->name()) + "' asks for a state ";
  if (size > kStateBytesMax)
    throw FlightComputerError(name + "of " + std::to_string(size) + " bytes (vbar_gnc_state_size); accepted: up to " +
                              std::to_string(kStateBytesMax));
  if (!std::has_single_bit(alignment) || alignment > kStateAlignmentMax)
    throw FlightComputerError(name + "that is aligned to " + std::to_string(alignment) +
                              " bytes (vbar_gnc_state_alignment); accepted: powers of two from 1 to " +
                              std::to_string(kStateAlignmentMax));
  return article;
}

/// Memory for the state of a test article, zeroed as a board zeroes it.
class StateMemory {
 public:
  StateMemory(std::size_t size, std::size_t alignment)
      : alignment_(alignment), bytes_(::operator new(size, std::align_val_t(alignment))) {
    std::memset(bytes_, 0, size);
  }
  ~StateMemory() { ::operator delete(bytes_, std::align_val_t(alignment_)); }
  StateMemory(const StateMemory&) = delete;
  StateMemory& operator=(const StateMemory&) = delete;
  [[nodiscard]] void* get() const { return bytes_; }

 private:
  std::size_t alignment_;
  void* bytes_;
};

class InProcess final : public FlightComputer {
 public:
  InProcess(std::shared_ptr<const TestArticle> article, std::uint8_t spacecraft,
            const fsw::packets::TelecommandSecurity* security)
      : article_(checked(std::move(article))), state_(article_->state_size(), article_->state_alignment()) {
    const vbar_status status = article_->init(state_.get(), spacecraft, &InProcess::sink, this);
    if (status != 0) {
      throw FlightComputerError("the flight software '" + std::string(article_->name()) +
                                "' refused to start: status " + std::to_string(status));
    }
    if (security == nullptr) return;
    if (article_->authenticate == nullptr) {
      throw FlightComputerError("the flight software '" + std::string(article_->name()) +
                                "' does not authenticate telecommands (it has no function vbar_gnc_authenticate)");
    }
    if (article_->authenticate(state_.get(), security->key.data(), security->index, security->sequence) != 0)
      throw FlightComputerError("the flight software '" + std::string(article_->name()) +
                                "' refused the key of telecommands");
  }

  StepResult step(std::uint32_t /*step*/, std::span<const Packet> packets) override {
    if (packets.empty()) throw FlightComputerError("a step needs at least its tick");
    const auto start = std::chrono::steady_clock::now();
    StepResult result;
    for (const Packet& packet : packets) {
      if (article_->receive(state_.get(), packet.data(), packet.size()) != 0) ++result.trouble.inputs_refused;
    }
    const auto last = fsw::packets::parse_packet(packets.back());
    if (last.ok() && fsw::packets::decode<vbar::tick>(last.value()).ok())
      result.trouble.status = article_->step(state_.get(), last.value().header.time.ns);
    for (std::uint16_t i = 0; i < outbox_.count(); ++i) {
      const auto packet = outbox_.packet(i);
      result.packets.emplace_back(packet.begin(), packet.end());
    }
    outbox_.clear();
    result.trouble.packets_dropped = std::exchange(dropped_, 0);
    result.compute_wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
  }

  [[nodiscard]] std::vector<std::uint8_t> snapshot() override {
    if (article_->save == nullptr) return {};
    std::vector<std::uint8_t> bytes(article_->snapshot_size());
    if (article_->save(state_.get(), bytes.data(), bytes.size()) != 0) return {};
    return bytes;
  }

  void restore(std::span<const std::uint8_t> snapshot) override {
    if (article_->restore == nullptr) return FlightComputer::restore(snapshot);
    const vbar_status status = article_->restore(state_.get(), snapshot.data(), snapshot.size());
    if (status != 0) {
      throw FlightComputerError("the flight software '" + std::string(article_->name()) +
                                "' refused the snapshot: status " + std::to_string(status));
    }
  }

  [[nodiscard]] LinkStatistics statistics() const override { return {}; }
  [[nodiscard]] std::string description() const override { return std::string("in process: ") + article_->name(); }
  void close() override {}

 private:
  static void sink(void* context, const std::uint8_t* packet, std::size_t size) {
    // Packets that do not fit are dropped, as on a board.
    auto* const computer = static_cast<InProcess*>(context);
    if (!computer->outbox_.append({packet, size})) ++computer->dropped_;
  }

  std::shared_ptr<const TestArticle> article_;
  StateMemory state_;
  boards::Outbox outbox_;
  std::uint32_t dropped_ = 0;  ///< packets, since the last answer
};

}  // namespace

std::unique_ptr<FlightComputer> make_in_process(std::shared_ptr<const TestArticle> article, std::uint8_t spacecraft,
                                                const fsw::packets::TelecommandSecurity* security) {
  return std::make_unique<InProcess>(std::move(article), spacecraft, security);
}

namespace {

using Clock = std::chrono::steady_clock;
using Bytes = std::vector<std::uint8_t>;

constexpr std::chrono::milliseconds kAfterSignal{1000};
/// Bytes of the longest answer: twice those of an outbox with the size of each packet.
constexpr std::uint32_t kAnswerMax = 2 * (boards::kOutboxBytes + boards::kOutboxPackets * sizeof(std::uint32_t));
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
    const auto count = number<std::uint32_t>();
    std::vector<Packet> all;
    for (std::uint32_t k = 0; k < count; ++k) {
      const auto bytes = take(number<std::uint32_t>());
      all.emplace_back(bytes.begin(), bytes.end());
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

enum class Transfer { kDone, kGone, kLate, kTooLong };

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

/// Receives a message of up to `size_max` bytes: a test article that writes to descriptors which are not its own may
/// have sent any other number.
Transfer receive_message(int socket, Bytes& message, Clock::time_point& deadline, std::uint32_t size_max = UINT32_MAX) {
  const auto take = [socket](auto bytes) { return ::recv(socket, bytes.data(), bytes.size(), MSG_DONTWAIT); };
  std::uint32_t size = 0;
  const std::span header(reinterpret_cast<std::uint8_t*>(&size), sizeof size);
  const Transfer first = transfer(socket, header, POLLIN, deadline, take);
  if (first != Transfer::kDone) return first;
  if (size > size_max) return Transfer::kTooLong;
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
    child_ = io::fork_leader();
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
    const Transfer received = receive_message(socket_.get(), message, deadline, kAnswerMax);
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
    if (transfer == Transfer::kTooLong) {
      stop(SIGKILL);
      throw FlightComputerError(name_ + " wrote to a descriptor that is not its own " + where + ", and was stopped");
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
