#include "host_sim/engine/clock.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <thread>
#include <utility>

namespace vbar::engine {

WallClock::Span SteadyWallClock::now() {
  return std::chrono::duration_cast<Span>(std::chrono::steady_clock::now().time_since_epoch());
}

void SteadyWallClock::sleep_until(Span wake) {
  std::this_thread::sleep_until(
      std::chrono::steady_clock::time_point(std::chrono::duration_cast<std::chrono::steady_clock::duration>(wake)));
}

const WallClockSource kMonotonicClock{
    "monotonic", [](std::string_view) -> std::unique_ptr<WallClock> { return std::make_unique<SteadyWallClock>(); }};

namespace {

// Longest sleep between two checks for a request to stop the run.
constexpr WallClock::Span kLongestSleep = std::chrono::milliseconds(100);

void book(Lateness& lateness, WallClock::Span late) {
  ++lateness.count;
  lateness.worst = std::max(lateness.worst, late);
}

}  // namespace

RunClock::RunClock(const ClockSettings& settings, WallClock& wall) : settings_(settings), wall_(wall) {}

void RunClock::start(fsw::GpsTime time) {
  start_ = time;
  wall_start_ = wall_.start_of_run();
}

WallClock::Span RunClock::on_the_wall(fsw::Duration simulated) const {
  return WallClock::Span(std::llround(static_cast<double>(simulated.ns) / settings_.speed_factor));
}

bool RunClock::sleep_until(WallClock::Span due, const std::function<bool()>& stop_requested) {
  for (WallClock::Span now = wall_.now(); now < due; now = wall_.now()) {
    if (stop_requested && stop_requested()) return false;
    wall_.sleep_until(std::min(due, now + kLongestSleep));
  }
  return true;
}

std::optional<RunClock::Arrival> RunClock::await(fsw::GpsTime time, const std::function<bool()>& stop_requested) {
  const WallClock::Span due = wall_start_ + on_the_wall(time - start_);
  const WallClock::Span behind = wall_.now() - due;
  if (behind >= WallClock::Span::zero()) return Arrival{false, behind};
  if (!sleep_until(due, stop_requested)) return std::nullopt;
  const WallClock::Span overslept = wall_.now() - due;
  if (overslept > settings_.wake_tolerance) book(report_.woke_late, overslept);
  arrears_ = overslept;
  exchange_late_ = false;  // its delay has been caught up with
  return Arrival{true, overslept};
}

bool RunClock::wait_until(fsw::GpsTime time, Lateness* late, const std::function<bool()>& stop_requested) {
  if (stop_requested && stop_requested()) return false;
  if (settings_.mode == ClockMode::kLockStep) return true;
  const std::optional<Arrival> arrival = await(time, stop_requested);
  if (!arrival) return false;
  if (late != nullptr && arrival->late > settings_.wake_tolerance) book(*late, arrival->late);
  return true;
}

bool RunClock::begin_step(fsw::GpsTime time, const std::function<bool()>& stop_requested) {
  if (stop_requested && stop_requested()) return false;
  if (settings_.mode == ClockMode::kRealTime) {
    const std::optional<Arrival> arrival = await(time, stop_requested);
    if (!arrival) return false;
    if (!arrival->slept) {
      // Arrears that only decrease, or that a late exchange explains, are not counted again.
      const WallClock::Span behind = arrival->late;
      if (behind > arrears_ + settings_.wake_tolerance && !exchange_late_) book(report_.simulation_late, behind);
      arrears_ = behind;
    }
    exchange_late_ = false;
  }
  ++report_.steps;
  return true;
}

void RunClock::end_exchange(WallClock::Span round_trip, WallClock::Span compute) {
  if (settings_.mode == ClockMode::kLockStep) return;
  const WallClock::Span compute_excess = compute - on_the_wall(settings_.compute_budget);
  const WallClock::Span link_excess = (round_trip - compute) - on_the_wall(settings_.link_budget);
  if (compute_excess > WallClock::Span::zero()) book(report_.step_late, compute_excess);
  if (link_excess > WallClock::Span::zero()) book(report_.link_late, link_excess);
  exchange_late_ = compute_excess > WallClock::Span::zero() || link_excess > WallClock::Span::zero();
}

Cadence::Cadence(std::vector<Part> parts) : parts_(std::move(parts)) {
  if (parts_.empty()) throw std::invalid_argument("a cadence without a period");
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    if (parts_[k].period.ns <= 0) throw std::invalid_argument("a period that is not above zero");
    if (k > 0 && parts_[k].from <= parts_[k - 1].from)
      throw std::invalid_argument("periods that are not in order of the times from which they hold");
  }
}

fsw::GpsTime Cadence::next_after(fsw::GpsTime time) const {
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    const auto& [from, period] = parts_[k];
    const std::int64_t passed = time < from ? 0 : (time - from).ns / period.ns;
    const fsw::GpsTime next = from + fsw::Duration{(passed + 1) * period.ns};
    if (k + 1 == parts_.size() || next <= parts_[k + 1].from) return next;
  }
  throw std::logic_error("a cadence without a period");
}

std::int64_t Cadence::number_of(fsw::GpsTime time) const {
  std::int64_t count = 0;
  for (std::size_t k = 0; k < parts_.size() && parts_[k].from < time; ++k) {
    const auto& [from, period] = parts_[k];
    // Epochs in (from, end): up to the beginning of the next part, which itself counts if it is before `time`.
    const bool is_last = k + 1 == parts_.size() || parts_[k + 1].from >= time;
    const fsw::Duration span = (is_last ? time - fsw::Duration{1} : parts_[k + 1].from) - from;
    count += span.ns / period.ns;
  }
  return count;
}

fsw::Duration Cadence::shortest_period() const {
  return std::ranges::min_element(parts_, {}, &Part::period)->period;
}

}  // namespace vbar::engine
