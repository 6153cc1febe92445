#pragma once
// Output of PPS edges to chronyd's reference clock SOCK, so that an independent program can judge them. The datagram is
// chrony's struct sock_sample in the byte order and type sizes of this computer, 40 bytes.

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "fsw/core/gps_time.h"
#include "hil_drivers/grand/pps/edge_clock.h"
#include "hil_drivers/grand/pps/edge_source.h"
#include "host_sim/engine/clock.h"

namespace vbar::grand {

inline constexpr std::size_t kChronySampleBytes = 40;

/// Returns a sample that states: at `realtime` of the system's clock, a whole second of the reference began (the
/// nearest one).
[[nodiscard]] std::array<std::uint8_t, kChronySampleBytes> chrony_sample(engine::WallClock::Span realtime);

class ChronyOutput {
 public:
  /// `path` is the socket of chronyd's `refclock SOCK`. Throws std::runtime_error for a path that cannot be a socket's.
  explicit ChronyOutput(const std::string& path);
  ~ChronyOutput();
  ChronyOutput(const ChronyOutput&) = delete;
  ChronyOutput& operator=(const ChronyOutput&) = delete;

  /// Sends the edge. Does not wait, and does not fail if no chronyd is listening.
  void forward(const Edge& edge);

  [[nodiscard]] std::uint64_t sent() const { return sent_; }

 private:
  struct State;
  std::unique_ptr<State> state_;
  std::uint64_t sent_ = 0;
};

// Time of a run in real time: that of the generator's edges or, without edges, of the host's clock from the generator's
// start.

class TimeBase final : public engine::WallClock {
 public:
  /// `start` is the start of the generator and of the run, `pps` the source of the edges (edge_source.h) or "none",
  /// `chrony` the socket to which they are forwarded (time_base.h), if not empty. Throws std::runtime_error if it
  /// cannot be opened.
  TimeBase(fsw::GpsTime start, const std::string& pps, const std::string& chrony = {});

  /// Begins the time of the run after the start of the generator. `host_start` is the start on the host's clock, if the
  /// generator states it; otherwise its edges give the start or, without edges, the time of this call. Waits for the
  /// first edge; throws std::runtime_error if there is none.
  void begin(std::optional<std::chrono::steady_clock::time_point> host_start);

  Span now() override { return clock().now(); }
  Span start_of_run() override { return start_of_run_; }
  void sleep_until(Span wake) override { clock().sleep_until(wake); }

  /// Present time, on the generator's time.
  [[nodiscard]] fsw::GpsTime time() { return start_ + fsw::Duration{(now() - start_of_run_).count()}; }

  /// Clock of the edges; null without edges.
  [[nodiscard]] const EdgeClock* edges() const { return edges_.get(); }
  /// Time of the last edge since the start; empty before the first.
  [[nodiscard]] std::optional<double> last_edge_s() const;

 private:
  [[nodiscard]] engine::WallClock& clock() { return edges_ ? static_cast<engine::WallClock&>(*edges_) : host_; }

  fsw::GpsTime start_;
  engine::SteadyWallClock host_;
  std::optional<ChronyOutput> chrony_;
  std::unique_ptr<EdgeClock> edges_;
  Span start_of_run_{0};
};

}  // namespace vbar::grand
