#pragma once
// A wall clock whose time a person pauses, steps and speeds up, for a run in real time. RunClock waits by it as by any
// other: what happens in the run is the same at every pace.

#include <functional>
#include <optional>

#include "host_sim/engine/clock.h"

namespace vbar::engine {

/// Bounds of the speed factor, as of clock.speed_factor.
inline constexpr double kSpeedFactorMin = 1e-3;
inline constexpr double kSpeedFactorMax = 1e6;

/// Pauses the run, lets it go on, or lets one flight step pass; sets the speed factor if that is above zero.
struct PaceRequest {
  enum class Kind { kNone, kPause, kGoOn, kStep };
  Kind kind = Kind::kNone;
  double speed_factor = 0.0;
};

class ControlledWallClock final : public WallClock {
 public:
  using Requests = std::function<std::optional<PaceRequest>()>;

  /// `wall` must outlive it; `speed_factor`: that of the RunClock which waits by this clock. `requests` returns the
  /// next one since the last call, or none; it and `stop_requested` are asked about ten times a second.
  ControlledWallClock(WallClock& wall, double speed_factor, Requests requests, std::function<bool()> stop_requested);

  /// Obeys the requests that have come. While the run is paused it returns only for a request, or to stop.
  Span now() override;
  Span start_of_run() override;
  void sleep_until(Span wake) override;

  /// To be called after each flight step, with the span that is simulated since the start of the run.
  void step_has_passed(fsw::Duration simulated);

 private:
  [[nodiscard]] Span present() const;
  void obey(const PaceRequest& request);

  WallClock& wall_;
  const double speed_factor_;
  Requests requests_;
  std::function<bool()> stop_requested_;
  Span start_{0};                  ///< of the run
  double rate_ = 1.0;              ///< of this clock's time against that of the wall
  Span since_{0}, since_wall_{0};  ///< the last change of pace by both clocks
  Span of_last_step_{0};           ///< time of the last step that has passed
  bool has_slept_ = false;         ///< the run is not late
  bool paused_ = false;
  bool one_step_passes_ = false;  ///< paused: until a step has passed
};

}  // namespace vbar::engine
