#pragma once
// Time of a 1PPS as a function of the host's monotonic clock, by a Kalman filter over the edges. Time here is in
// seconds of the edge source, divided by the speed factor, since the first edge.
//
// State: [p, r], offset (s) and rate error (s/s) of the edges' time against the host's clock.
// Propagation by dt: p' = p + r dt, r a random walk of spectral density q = rate_walk^2, with covariance Q = q [dt^3/3,
// dt^2/2; dt^2/2, dt]. An edge measures p with edge_sigma_s. (Bar-Shalom, Li, Kirubarajan: Estimation with Applications
// to Tracking and Navigation, 2001, section 6.2.2.)

#include <cstdint>
#include <optional>

#include "hil_drivers/grand/pps/edge_source.h"

namespace vbar::grand {

struct EdgeFilterSettings {
  double edge_sigma_s = 100e-6;        ///< jitter of one edge
  double rate_walk = 1e-8;             ///< random walk of the rate error, per square root of a second
  double initial_rate_sigma = 100e-6;  ///< rate error of the host's clock before the first edges
  double gate_sigmas = 3.0;
  int accept_after = 3;       ///< consecutive rejected edges that agree with each other until they are accepted
  double speed_factor = 1.0;  ///< seconds of the edges per second of the host's clock
};

enum class EdgeVerdict { kAccepted, kDoubled, kRejected, kReinitialised };

class EdgeFilter {
 public:
  using Span = engine::WallClock::Span;

  explicit EdgeFilter(const EdgeFilterSettings& settings) : settings_(settings) {}

  /// Processes an edge. Edges come in the order of their arrival.
  EdgeVerdict add(const Edge& edge);

  [[nodiscard]] bool has_started() const { return started_; }
  /// Converts a time of the host's clock to the time of the edges, and back. The first edge has time 0.
  [[nodiscard]] Span at(Span host) const;
  [[nodiscard]] Span host_at(Span time) const;

  /// GPS time of the first edge according to the present labels; empty if the edges have none.
  [[nodiscard]] std::optional<fsw::GpsTime> origin_gps() const { return origin_gps_; }

  /// Predicted minus measured time of the last edge that was not doubled, s, before the edge was used.
  [[nodiscard]] double host_minus_edge_s() const { return host_minus_edge_s_; }
  /// Time of the last edge that was not doubled, and whole seconds of the source since the one before.
  [[nodiscard]] Span edge_time() const { return last_label_; }
  [[nodiscard]] std::int64_t seconds_since_previous() const { return seconds_since_previous_; }

  /// Rate error of the host's clock: positive if the edges' seconds are shorter than the host's.
  [[nodiscard]] double rate_error() const { return rate_; }
  [[nodiscard]] double offset_sigma_s() const;
  [[nodiscard]] double rate_sigma() const;

 private:
  void start(const Edge& edge);
  void propagate(Span host);
  void update(double innovation_s);
  void move_to(double innovation_s);
  [[nodiscard]] double innovation_variance() const { return p00_ + settings_.edge_sigma_s * settings_.edge_sigma_s; }
  [[nodiscard]] Span period() const;
  [[nodiscard]] Span label_of(const Edge& edge, std::int64_t seconds) const;
  EdgeVerdict reject(double innovation_s);

  EdgeFilterSettings settings_;
  bool started_ = false;
  std::optional<fsw::GpsTime> origin_gps_;
  // State and covariance at `epoch_` of the host's clock: the edges' time there is time_ + offset_.
  Span epoch_{0};
  Span time_{0};
  double offset_ = 0.0;  ///< below a nanosecond after each update
  double rate_ = 0.0;
  double p00_ = 0.0, p01_ = 0.0, p11_ = 0.0;

  Span last_host_{0};   ///< time of the last edge that was not doubled
  Span last_label_{0};  ///< its time by the source's count of seconds
  std::int64_t seconds_since_previous_ = 0;
  double host_minus_edge_s_ = 0.0;
  int rejected_in_a_row_ = 0;
  double rejected_innovation_s_ = 0.0;
};

}  // namespace vbar::grand
