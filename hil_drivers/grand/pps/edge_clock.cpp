#include "hil_drivers/grand/pps/edge_clock.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace vbar::grand {
namespace {

using Span = engine::WallClock::Span;
using namespace std::chrono_literals;

/// Edges are looked for at least this often while the clock sleeps.
constexpr Span kLongestSleep = 100ms;
/// Longest time between two requests for edges. After a longer one (the host was paused) the silence counts from the
/// next request on: edges may have been lost on this side.
constexpr Span kPause = 2s;
/// An edge cannot be in the future; more than this is a wrong time stamp.
constexpr Span kFutureTolerance = 1s;

double seconds_of(Span span) {
  return std::chrono::duration<double>(span).count();
}

}  // namespace

EdgeClock::EdgeClock(std::unique_ptr<EdgeSource> source, std::unique_ptr<engine::WallClock> host,
                     const EdgeClockSettings& settings)
    : source_(std::move(source)),
      host_(std::move(host)),
      settings_(settings),
      filter_(settings.filter),
      start_(host_->now()),
      last_looked_(start_),
      silent_since_(start_) {}

void EdgeClock::wait_for_edges(std::uint64_t edges, Span patience) {
  const Span deadline = host_->now() + patience;
  for (take_edges(); statistics_.used < edges; take_edges()) {
    const Span now = host_->now();
    if (now >= deadline)
      throw std::runtime_error(
          fmt::format("{}: {} usable edges of the 1PPS within {:.0f} s, {} are needed: check that the source is "
                      "running and connected",
                      source_->description(), statistics_.used, seconds_of(patience), edges));
    host_->sleep_until(std::min(deadline, now + kLongestSleep));
  }
}

void EdgeClock::take_edges() {
  // A source that floods does not hold the caller.
  constexpr int kMaxEdges = 256;
  const Span now = host_->now();
  if (now - last_looked_ > kPause) silent_since_ = std::max(silent_since_, now);
  last_looked_ = now;
  for (int k = 0; k < kMaxEdges; ++k) {
    const std::optional<Edge> edge = source_->next(std::chrono::steady_clock::time_point{});
    if (!edge) return;
    take(*edge, host_->now());
  }
}

void EdgeClock::take(const Edge& edge, Span host_now) {
  ++statistics_.edges;
  if (settings_.on_edge) settings_.on_edge(edge);
  const bool is_plausible =
      edge.monotonic <= host_now + kFutureTolerance && edge.monotonic >= host_now - settings_.longest_silence;
  if (!is_plausible) {
    ++statistics_.rejected;
    return;
  }
  const bool first = !filter_.has_started();
  const EdgeVerdict verdict = filter_.add(edge);
  if (verdict == EdgeVerdict::kDoubled) {
    ++statistics_.doubled;
    return;
  }
  if (!first) {
    statistics_.missing += static_cast<std::uint64_t>(filter_.seconds_since_previous() - 1);
    statistics_.host_minus_edge_s.push_back(filter_.host_minus_edge_s());
  }
  if (verdict == EdgeVerdict::kRejected) {
    ++statistics_.rejected;
    return;
  }
  ++statistics_.used;
  if (verdict == EdgeVerdict::kReinitialised) {
    ++statistics_.jumps;
    if (std::abs(filter_.host_minus_edge_s()) > seconds_of(settings_.longest_silence))
      far_jump_s_ = -filter_.host_minus_edge_s();
  }
  if (verdict == EdgeVerdict::kAccepted) sum_of_squares_s2_ += std::pow(filter_.host_minus_edge_s(), 2);
  if (!first)
    statistics_.longest_silence_s = std::max(statistics_.longest_silence_s, seconds_of(edge.monotonic - last_used_));
  last_used_ = edge.monotonic;
  silent_since_ = std::max(silent_since_, edge.monotonic);
}

void EdgeClock::require_edges(Span host_now) const {
  if (far_jump_s_)
    throw std::runtime_error(fmt::format(
        "{}: the edges of the 1PPS have jumped by {:+.3f} s, so that real time cannot go on: check whether the "
        "generator was started again with another scenario",
        source_->description(), *far_jump_s_));
  const Span silence = host_now - silent_since_;
  if (silence < settings_.longest_silence) return;
  throw std::runtime_error(fmt::format(
      "{}: no usable edge of the 1PPS for {:.0f} s ({} received so far, {} rejected), so that real time cannot "
      "go on: check the generator and the PPS line",
      source_->description(), seconds_of(silence), statistics_.edges, statistics_.rejected));
}

Span EdgeClock::now() {
  take_edges();
  const Span host_now = host_->now();
  require_edges(host_now);
  latest_ = std::max(latest_, at(host_now));
  return latest_;
}

void EdgeClock::sleep_until(Span wake) {
  for (Span present = now(); present < wake; present = now()) {
    const Span host_now = host_->now();
    const Span due = std::max(host_at(wake), host_now + 1ns);
    host_->sleep_until(std::min(due, host_now + kLongestSleep));
  }
}

Span EdgeClock::at(Span host) const {
  return filter_.has_started() ? filter_.at(host) : host - start_;
}

Span EdgeClock::host_at(Span time) const {
  return filter_.has_started() ? filter_.host_at(time) : start_ + time;
}

std::optional<fsw::GpsTime> EdgeClock::gps_at(Span time) const {
  const auto origin = filter_.origin_gps();
  if (!origin) return std::nullopt;
  return *origin + fsw::Duration{std::llround(static_cast<double>(time.count()) * settings_.filter.speed_factor)};
}

std::optional<Span> EdgeClock::at_gps(fsw::GpsTime gps) const {
  const auto origin = filter_.origin_gps();
  if (!origin) return std::nullopt;
  return Span(std::llround(static_cast<double>((gps - *origin).ns) / settings_.filter.speed_factor));
}

EdgeStatistics EdgeClock::statistics() const {
  EdgeStatistics statistics = statistics_;
  statistics.malformed = source_->malformed();
  const std::uint64_t measured = statistics.used - statistics.jumps;
  // The first edge was not predicted.
  if (measured > 1) statistics.jitter_s = std::sqrt(sum_of_squares_s2_ / static_cast<double>(measured - 1));
  statistics.rate_error = filter_.rate_error();
  return statistics;
}

std::optional<Span> EdgeClock::last_edge() const {
  if (!filter_.has_started()) return std::nullopt;
  return filter_.edge_time();
}

namespace {

std::unique_ptr<engine::WallClock> make_pps_clock(std::string_view device) {
  constexpr std::uint64_t kFirstEdges = 3;
  constexpr Span kPatience = 10s;
  auto clock = std::make_unique<EdgeClock>(make_edge_source(device), std::make_unique<engine::SteadyWallClock>());
  clock->wait_for_edges(kFirstEdges, kPatience);
  return clock;
}

}  // namespace

const engine::WallClockSource kPpsClock{"pps", make_pps_clock};

}  // namespace vbar::grand
