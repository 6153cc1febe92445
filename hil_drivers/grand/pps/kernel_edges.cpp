#include "hil_drivers/grand/pps/kernel_edges.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/timepps.h>
#include <time.h>

#include "host_sim/io/file_descriptor.h"

namespace vbar::grand {
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

}  // namespace vbar::grand
