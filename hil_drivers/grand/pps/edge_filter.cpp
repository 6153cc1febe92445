#include "hil_drivers/grand/pps/edge_filter.h"

#include <algorithm>
#include <cmath>

namespace vbar::grand {
namespace {

using Span = engine::WallClock::Span;

double seconds_of(Span span) {
  return std::chrono::duration<double>(span).count();
}

Span span_of(double s) {
  return Span(std::llround(s * 1e9));
}

/// The rate is known no better than this after the edges have moved: what moved them may have changed it, too.
constexpr double kRateSigmaAfterJump = 1e-6;

}  // namespace

Span EdgeFilter::period() const {
  return span_of(1.0 / settings_.speed_factor);
}

EdgeVerdict EdgeFilter::add(const Edge& edge) {
  if (!started_) {
    start(edge);
    return EdgeVerdict::kAccepted;
  }
  const Span since_last = edge.monotonic - last_host_;
  if (since_last < period() / 2) return EdgeVerdict::kDoubled;
  propagate(edge.monotonic);
  const double predicted_s = seconds_of(time_ - last_label_) + offset_;
  const auto seconds = std::max<std::int64_t>(1, std::llround(predicted_s * settings_.speed_factor));
  const Span label = label_of(edge, seconds);
  const double innovation_s = seconds_of(label - time_) - offset_;
  host_minus_edge_s_ = -innovation_s;
  seconds_since_previous_ =
      std::max<std::int64_t>(1, std::llround(seconds_of(since_last) * (1.0 + rate_) * settings_.speed_factor));
  last_host_ = edge.monotonic;
  last_label_ = label;
  if (std::abs(innovation_s) > settings_.gate_sigmas * std::sqrt(innovation_variance())) return reject(innovation_s);
  rejected_in_a_row_ = 0;
  update(innovation_s);
  return EdgeVerdict::kAccepted;
}

void EdgeFilter::start(const Edge& edge) {
  started_ = true;
  origin_gps_ = edge.gps;
  epoch_ = last_host_ = edge.monotonic;
  p00_ = settings_.edge_sigma_s * settings_.edge_sigma_s;
  p11_ = settings_.initial_rate_sigma * settings_.initial_rate_sigma;
}

/// A source without labels is taken to have counted on.
Span EdgeFilter::label_of(const Edge& edge, std::int64_t seconds) const {
  if (edge.gps && origin_gps_) {
    const double since_origin_s = static_cast<double>(edge.gps->ns - origin_gps_->ns) / settings_.speed_factor;
    return Span(settings_.speed_factor == 1.0 ? edge.gps->ns - origin_gps_->ns : std::llround(since_origin_s));
  }
  return last_label_ + span_of(static_cast<double>(seconds) / settings_.speed_factor);
}

void EdgeFilter::propagate(Span host) {
  const double dt = seconds_of(host - epoch_);
  const double q = settings_.rate_walk * settings_.rate_walk;
  time_ += host - epoch_;
  epoch_ = host;
  offset_ += rate_ * dt;
  p00_ += dt * (2.0 * p01_ + dt * p11_) + q * dt * dt * dt / 3.0;
  p01_ += dt * p11_ + q * dt * dt / 2.0;
  p11_ += q * dt;
}

void EdgeFilter::update(double innovation_s) {
  const double s = innovation_variance();
  const double gain_offset = p00_ / s;
  const double gain_rate = p01_ / s;
  offset_ += gain_offset * innovation_s;
  rate_ += gain_rate * innovation_s;
  p11_ -= gain_rate * p01_;
  p01_ -= gain_offset * p01_;
  p00_ -= gain_offset * p00_;
  const Span whole = span_of(offset_);
  time_ += whole;
  offset_ -= seconds_of(whole);
}

EdgeVerdict EdgeFilter::reject(double innovation_s) {
  // Two edges differ by the jitter of both; the rate may be off by its uncertainty over the time between them.
  const double gate = settings_.gate_sigmas * std::sqrt(2.0 * innovation_variance());
  const bool agrees = rejected_in_a_row_ > 0 && std::abs(innovation_s - rejected_innovation_s_) <= gate;
  rejected_in_a_row_ = agrees ? rejected_in_a_row_ + 1 : 1;
  rejected_innovation_s_ = innovation_s;
  if (rejected_in_a_row_ < settings_.accept_after) return EdgeVerdict::kRejected;
  move_to(innovation_s);
  return EdgeVerdict::kReinitialised;
}

void EdgeFilter::move_to(double innovation_s) {
  const Span moved = span_of(offset_ + innovation_s);
  time_ += moved;
  offset_ = 0.0;
  p00_ = settings_.edge_sigma_s * settings_.edge_sigma_s;
  p01_ = 0.0;
  p11_ = std::max(p11_, kRateSigmaAfterJump * kRateSigmaAfterJump);
  rejected_in_a_row_ = 0;
}

Span EdgeFilter::at(Span host) const {
  const double dt = seconds_of(host - epoch_);
  return time_ + (host - epoch_) + span_of(offset_ + rate_ * dt);
}

Span EdgeFilter::host_at(Span time) const {
  const Span elapsed = time - time_;
  const double dt = (seconds_of(elapsed) - offset_) / (1.0 + rate_);
  return epoch_ + elapsed + span_of(-offset_ - rate_ * dt);
}

double EdgeFilter::offset_sigma_s() const {
  return std::sqrt(p00_);
}

double EdgeFilter::rate_sigma() const {
  return std::sqrt(p11_);
}

}  // namespace vbar::grand
