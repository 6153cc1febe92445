#pragma once
// Wall clock that follows the edges of a 1PPS. Edges are gated; without edges it continues at the last rate, for a
// limited time. Corrections never set it back: it halts until time has caught up.

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "hil_drivers/grand/pps/edge_filter.h"
#include "hil_drivers/grand/pps/edge_source.h"

namespace vbar::grand {

struct EdgeClockSettings {
  EdgeFilterSettings filter{};
  engine::WallClock::Span longest_silence = std::chrono::seconds(60);  ///< without a usable edge
  std::function<void(const Edge&)> on_edge{};                          ///< sees every edge received
};

struct EdgeStatistics {
  std::uint64_t edges = 0;  ///< edges received, of which:
  std::uint64_t used = 0;
  std::uint64_t doubled = 0;
  std::uint64_t rejected = 0;
  std::uint64_t missing = 0;              ///< seconds without an edge between two edges
  std::uint64_t jumps = 0;                ///< edges that have moved, and that the clock has followed
  std::uint64_t malformed = 0;            ///< datagrams that are not edges
  double jitter_s = 0.0;                  ///< RMS of predicted minus measured time of the edges used
  double rate_error = 0.0;                ///< rate error of the host's clock, s/s
  double longest_silence_s = 0.0;         ///< longest time between two edges that were used
  std::vector<double> host_minus_edge_s;  ///< predicted minus measured, every edge that was not doubled
};

class EdgeClock final : public engine::WallClock {
 public:
  /// `host` has the time of std::chrono::steady_clock.
  EdgeClock(std::unique_ptr<EdgeSource> source, std::unique_ptr<engine::WallClock> host,
            const EdgeClockSettings& settings = {});

  /// Returns when `edges` edges have been used. Throws std::runtime_error, one sentence, if that takes longer than
  /// `patience`.
  void wait_for_edges(std::uint64_t edges, Span patience);

  /// Returns the time since the first edge; before it, that of the host's clock since the construction. Both functions
  /// throw std::runtime_error, one sentence, if there has been no usable edge for settings.longest_silence, or if the
  /// edges have jumped by more.
  Span now() override;
  void sleep_until(Span wake) override;

  /// Converts between this clock and the host's. The result is not limited by what now() has returned before.
  [[nodiscard]] Span at(Span host) const;
  [[nodiscard]] Span host_at(Span time) const;

  /// Converts between this clock and the time of the edges' labels; empty if they have none, or before the first edge.
  [[nodiscard]] std::optional<fsw::GpsTime> gps_at(Span time) const;
  [[nodiscard]] std::optional<Span> at_gps(fsw::GpsTime gps) const;

  [[nodiscard]] EdgeStatistics statistics() const;
  /// Last edge that was not doubled: its time, and predicted minus measured, s.
  [[nodiscard]] std::optional<Span> last_edge() const;
  [[nodiscard]] double host_minus_edge_s() const { return filter_.host_minus_edge_s(); }
  [[nodiscard]] const EdgeFilter& filter() const { return filter_; }

 private:
  void take_edges();
  void take(const Edge& edge, Span host_now);
  void require_edges(Span host_now) const;

  std::unique_ptr<EdgeSource> source_;
  std::unique_ptr<engine::WallClock> host_;
  EdgeClockSettings settings_;
  EdgeFilter filter_;
  EdgeStatistics statistics_;
  double sum_of_squares_s2_ = 0.0;
  std::optional<double> far_jump_s_;
  Span start_{0};         ///< on the host's clock
  Span last_looked_{0};   ///< last time at which edges were requested
  Span silent_since_{0};  ///< last edge used, or end of a time in which none was requested
  Span last_used_{0};     ///< last edge used
  Span latest_{0};        ///< last result of now()
};

/// "pps:<edge source>": waits for the first edges when a run begins.
extern const engine::WallClockSource kPpsClock;

}  // namespace vbar::grand
