#pragma once
// Time of a run in real time: that of the generator's edges or, without edges, of the host's clock from the generator's
// start.

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "fsw/core/gps_time.h"
#include "hil_drivers/grand/pps/chrony_output.h"
#include "hil_drivers/grand/pps/edge_clock.h"
#include "host_sim/engine/wall_clock.h"

namespace vbar::grand {

class TimeBase final : public engine::WallClock {
 public:
  /// `start` is the start of the generator and of the run, `pps` the source of the edges (edge_source.h) or "none",
  /// `chrony` the socket to which they are forwarded (chrony_output.h), if not empty. Throws std::runtime_error if it
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
