#include "host_sim/engine/controlled_wall_clock.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace vbar::engine {

namespace {

constexpr WallClock::Span kBetweenLooks = std::chrono::milliseconds(100);

WallClock::Span scaled(WallClock::Span span, double factor) {
  return WallClock::Span(std::llround(static_cast<double>(span.count()) * factor));
}

}  // namespace

ControlledWallClock::ControlledWallClock(WallClock& wall, double speed_factor, Requests requests,
                                         std::function<bool()> stop_requested)
    : wall_(wall),
      speed_factor_(speed_factor),
      requests_(std::move(requests)),
      stop_requested_(std::move(stop_requested)) {}

WallClock::Span ControlledWallClock::present() const {
  return paused_ ? since_ : since_ + scaled(wall_.now() - since_wall_, rate_);
}

WallClock::Span ControlledWallClock::start_of_run() {
  start_ = since_ = since_wall_ = of_last_step_ = wall_.start_of_run();
  return start_;
}

void ControlledWallClock::obey(const PaceRequest& request) {
  // A run that is late is at its last step, and goes on from there: its lateness ends with the pace that caused it.
  since_ = paused_ || has_slept_ ? present() : std::min(present(), of_last_step_);
  since_wall_ = wall_.now();
  if (request.speed_factor > 0.0) rate_ = request.speed_factor / speed_factor_;
  if (request.kind == PaceRequest::Kind::kNone) return;
  paused_ = request.kind != PaceRequest::Kind::kGoOn;
  one_step_passes_ = request.kind == PaceRequest::Kind::kStep;
}

WallClock::Span ControlledWallClock::now() {
  while (true) {
    while (const std::optional<PaceRequest> request = requests_()) obey(*request);
    has_slept_ = false;
    if (!paused_ || one_step_passes_ || stop_requested_()) return present();
    wall_.sleep_until(wall_.now() + kBetweenLooks);
  }
}

void ControlledWallClock::sleep_until(Span wake) {
  has_slept_ = true;
  if (paused_) {
    since_ = std::max(since_, wake);  // of the step that passes
    return;
  }
  const Span left = scaled(wake - present(), 1.0 / rate_);
  wall_.sleep_until(wall_.now() + std::min(left, kBetweenLooks));
}

void ControlledWallClock::step_has_passed(fsw::Duration simulated) {
  of_last_step_ = start_ + scaled(Span(simulated.ns), 1.0 / speed_factor_);
  one_step_passes_ = false;
}

}  // namespace vbar::engine
