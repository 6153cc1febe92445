#include "hil_drivers/grand/pps/edge_source.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/datagram_protocol.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <sys/timepps.h>
#include <time.h>

#include "hil_drivers/grand/wire/pps_datagram.h"
#include "host_sim/io/file_descriptor.h"

namespace vbar::grand {

namespace {

constexpr const EdgeSourceKind* kEdgeSourceKinds[] = {&kKernelEdges, &kSocketEdges, &kTimerEdges};

std::string_view device_of(std::string_view text) {
  const std::size_t colon = text.find(':');
  return colon == std::string_view::npos ? std::string_view() : text.substr(colon + 1);
}

}  // namespace

std::span<const EdgeSourceKind* const> edge_source_kinds() {
  return kEdgeSourceKinds;
}

const EdgeSourceKind* find_edge_source(std::string_view text) {
  const std::string_view name = text.substr(0, text.find(':'));
  const auto found =
      std::ranges::find_if(kEdgeSourceKinds, [&](const EdgeSourceKind* kind) { return kind->name == name; });
  if (found == std::end(kEdgeSourceKinds)) return nullptr;
  return (*found)->has_device == !device_of(text).empty() ? *found : nullptr;
}

std::unique_ptr<EdgeSource> make_edge_source(std::string_view text) {
  const EdgeSourceKind* const kind = find_edge_source(text);
  if (kind == nullptr)
    throw std::runtime_error(
        fmt::format("\"{}\" is not a source of PPS edges; accepted: {}", text, edge_source_forms()));
  return kind->make(std::string(device_of(text)));
}

std::string edge_source_forms() {
  std::vector<std::string> forms;
  for (const EdgeSourceKind* const kind : kEdgeSourceKinds) forms.push_back(fmt::format("\"{}\"", kind->form));
  return fmt::format("{}", fmt::join(forms, ", "));
}

namespace {

using Clock = std::chrono::steady_clock;
using Span = engine::WallClock::Span;

/// An edge between two calls of time_pps_fetch does not end the second one: it is found after this time at the latest.
constexpr Span kLongestFetch = std::chrono::milliseconds(100);

Span span_of(const timespec& time) {
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

Span read_clock(clockid_t id) {
  timespec time{};
  ::clock_gettime(id, &time);
  return span_of(time);
}

/// CLOCK_MONOTONIC minus CLOCK_REALTIME: the kernel stamps edges in the latter.
Span monotonic_minus_realtime() {
  const Span before = read_clock(CLOCK_MONOTONIC);
  const Span realtime = read_clock(CLOCK_REALTIME);
  const Span after = read_clock(CLOCK_MONOTONIC);
  return before + (after - before) / 2 - realtime;
}

class KernelEdges final : public EdgeSource {
 public:
  explicit KernelEdges(const std::string& device) : device_(device), file_(::open(device.c_str(), O_RDWR | O_CLOEXEC)) {
    if (file_.get() < 0) fail("opening the PPS device");
    if (::time_pps_create(file_.get(), &handle_) != 0) fail("this is not a PPS device");
    int capabilities = 0;
    if (::time_pps_getcap(handle_, &capabilities) != 0) fail("time_pps_getcap");
    if ((capabilities & PPS_CAPTUREASSERT) == 0)
      throw std::runtime_error(fmt::format("{}: the device does not capture assert edges", device_));
    can_wait_ = (capabilities & PPS_CANWAIT) != 0;
    capture_assert_edges();
    pps_info_t info{};
    if (fetch(Span::zero(), info)) sequence_ = info.assert_sequence;  // the edge before the first one of interest
  }

  std::optional<Edge> next(Clock::time_point deadline) override {
    for (;;) {
      pps_info_t info{};
      if (fetch(Span::zero(), info) && info.assert_sequence != sequence_) return edge_of(info);
      const Clock::time_point now = Clock::now();
      if (now >= deadline) return std::nullopt;
      wait_for_edge(std::min<Span>(deadline - now, kLongestFetch));
    }
  }

  [[nodiscard]] std::string description() const override { return "kernel:" + device_; }

 private:
  [[noreturn]] void fail(std::string_view what) const {
    throw std::runtime_error(fmt::format("{}: {}: {}", device_, what, std::strerror(errno)));
  }

  void capture_assert_edges() {
    pps_params_t parameters{};
    if (::time_pps_getparams(handle_, &parameters) != 0) fail("time_pps_getparams");
    constexpr int kNeeded = PPS_CAPTUREASSERT | PPS_TSFMT_TSPEC;
    // Setting a mode that is set already may need a permission that reading does not.
    if ((parameters.mode & kNeeded) == kNeeded) return;
    parameters.api_version = PPS_API_VERS_1;
    parameters.mode |= kNeeded;
    if (::time_pps_setparams(handle_, &parameters) != 0) fail("time_pps_setparams");
  }

  /// The last edge; false if there was none in time.
  bool fetch(Span timeout, pps_info_t& info) {
    timespec limit{};
    limit.tv_nsec = timeout.count();
    if (::time_pps_fetch(handle_, PPS_TSFMT_TSPEC, &info, &limit) == 0) return true;
    if (errno != ETIMEDOUT && errno != EINTR && errno != EAGAIN) fail("time_pps_fetch");
    return false;
  }

  void wait_for_edge(Span timeout) {
    if (can_wait_) {
      pps_info_t info{};
      fetch(timeout, info);
    } else {
      constexpr Span kPollPeriod = std::chrono::milliseconds(5);
      const timespec pause{0, std::min(timeout, kPollPeriod).count()};
      ::nanosleep(&pause, nullptr);
    }
  }

  Edge edge_of(const pps_info_t& info) {
    sequence_ = info.assert_sequence;
    return {std::nullopt, span_of(info.assert_timestamp) + monotonic_minus_realtime(),
            static_cast<std::uint32_t>(info.assert_sequence)};
  }

  std::string device_;
  io::FileDescriptor file_;
  pps_handle_t handle_ = -1;
  bool can_wait_ = false;
  pps_seq_t sequence_ = 0;
};

}  // namespace

const EdgeSourceKind kKernelEdges{
    "kernel", "kernel:DEVICE", true,
    [](const std::string& device) -> std::unique_ptr<EdgeSource> { return std::make_unique<KernelEdges>(device); }};

namespace {

namespace asio = boost::asio;
using asio::local::datagram_protocol;
using boost::system::error_code;

/// After this silence the sender may be another one, which does not have this client among its subscribers.
constexpr std::chrono::seconds kSubscribeAgainAfter{2};

datagram_protocol::endpoint endpoint_of(const std::string& path) {
  try {
    return {path};
  } catch (const boost::system::system_error& error) {
    throw std::runtime_error(fmt::format("socket:{}: {}", path, error.code().message()));
  }
}

class SocketEdges final : public EdgeSource {
 public:
  explicit SocketEdges(const std::string& path) : path_(path), sender_(endpoint_of(path)), socket_(context_) {
    error_code error;
    socket_.open(datagram_protocol(), error);
    // An empty endpoint: the system chooses an address, to which the sender can reply.
    if (!error) socket_.bind(datagram_protocol::endpoint(), error);
    if (!error) socket_.non_blocking(true, error);
    if (error) throw std::runtime_error(fmt::format("{}: {}", description(), error.message()));
  }

  std::optional<Edge> next(Clock::time_point deadline) override {
    for (;;) {
      if (const auto edge = receive()) return edge;
      const Clock::time_point now = Clock::now();
      if (now >= subscribe_at_) subscribe(now);
      if (now >= deadline) return receive();
      wait(std::min(deadline, subscribe_at_) - now);
    }
  }

  [[nodiscard]] std::string description() const override { return "socket:" + path_; }
  [[nodiscard]] std::uint64_t malformed() const override { return malformed_; }

 private:
  /// A connected socket receives from its peer only. That no sender is there is not an error: the bench may start
  /// later.
  void subscribe(Clock::time_point now) {
    constexpr std::chrono::milliseconds kRetryAfter{200};
    constexpr std::array<std::uint8_t, 1> kRequest{1};
    error_code error;
    socket_.connect(sender_, error);
    if (!error) socket_.send(asio::buffer(kRequest), 0, error);
    subscribe_at_ = now + (error ? Clock::duration(kRetryAfter) : Clock::duration(kSubscribeAgainAfter));
  }

  std::optional<Edge> receive() {
    // A flood of malformed datagrams does not hold the caller.
    constexpr int kMaxDatagrams = 64;
    for (int k = 0; k < kMaxDatagrams; ++k) {
      std::array<std::uint8_t, wire::kPpsDatagramBytes + 1> bytes{};
      error_code error;
      const std::size_t size = socket_.receive(asio::buffer(bytes), 0, error);
      if (error) return std::nullopt;  // nothing there, or the sender has gone
      if (const auto datagram = wire::decode_pps_datagram(std::span(bytes).first(size))) {
        subscribe_at_ = Clock::now() + kSubscribeAgainAfter;
        return Edge{datagram->gps, std::chrono::nanoseconds(datagram->monotonic_ns), datagram->count};
      }
      ++malformed_;
    }
    return std::nullopt;
  }

  void wait(Clock::duration limit) {
    pollfd poll{socket_.native_handle(), POLLIN, 0};
    const auto ms = std::chrono::ceil<std::chrono::milliseconds>(limit).count();
    ::poll(&poll, 1, static_cast<int>(std::clamp<std::int64_t>(ms, 0, 1000)));
  }

  std::string path_;
  datagram_protocol::endpoint sender_;
  asio::io_context context_;
  datagram_protocol::socket socket_;
  Clock::time_point subscribe_at_{};
  std::uint64_t malformed_ = 0;
};

}  // namespace

const EdgeSourceKind kSocketEdges{
    "socket", "socket:PATH", true,
    [](const std::string& path) -> std::unique_ptr<EdgeSource> { return std::make_unique<SocketEdges>(path); }};

namespace {

class TimerEdges final : public EdgeSource {
 public:
  std::optional<Edge> next(Clock::time_point deadline) override {
    const Clock::time_point due = start_ + std::chrono::seconds(count_);
    if (Clock::now() < due) std::this_thread::sleep_until(std::min(due, deadline));
    if (Clock::now() < due) return std::nullopt;
    return Edge{std::nullopt, due.time_since_epoch(), count_++};
  }
  [[nodiscard]] std::string description() const override { return "timer"; }

 private:
  Clock::time_point start_ = Clock::now();
  std::uint32_t count_ = 0;
};

}  // namespace

const EdgeSourceKind kTimerEdges{"timer", "timer", false, [](const std::string&) -> std::unique_ptr<EdgeSource> {
                                   return std::make_unique<TimerEdges>();
                                 }};

}  // namespace vbar::grand
