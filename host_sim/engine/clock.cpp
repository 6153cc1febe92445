#include "host_sim/engine/clock.h"

#include <algorithm>
#include <cmath>

namespace vbar::engine {
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

}  // namespace vbar::engine
