#pragma once
// Simulated time against wall-clock time: lock-step (as fast as possible; simulated time waits for all parts) or real
// time (paced by the wall clock, with a speed factor). The clock changes when events occur in wall-clock time, never
// what happens: both modes and every speed factor give the same run.
//
// In real time it records lateness, one column per cause, because each cause has a different remedy:
//   step late         the flight computer's own computing exceeded its budget
//   link late         what the exchange of a step took beyond the computing exceeded the link's budget
//   woke late         the operating system resumed this program later than requested
//   simulation late   this program was still busy (truth, renderer, testbed) when the next step was due
// A late step is not skipped: the schedule stays, and the run catches up.

#include <cstdint>
#include <functional>
#include <optional>

#include "fsw/core/gps_time.h"
#include "host_sim/engine/wall_clock.h"

namespace vbar::engine {

enum class ClockMode { kLockStep, kRealTime };

struct ClockSettings {
  ClockMode mode = ClockMode::kLockStep;
  double speed_factor = 1.0;  ///< real time: simulated seconds per second of wall-clock time, > 0
  fsw::Duration compute_budget =
      fsw::duration_of_seconds(1);                          ///< simulated time: wall-clock time times the speed factor
  fsw::Duration link_budget = fsw::duration_of_seconds(1);  ///< as compute_budget
  WallClock::Span wake_tolerance = std::chrono::milliseconds(2);  ///< waking up to this late is not counted
};

struct Lateness {
  std::uint64_t count = 0;
  WallClock::Span worst{0};  ///< wall-clock time beyond the budget, including the tolerance if there is one
};

struct DeadlineReport {
  std::uint64_t steps = 0;  ///< steps that have started
  Lateness step_late;
  Lateness link_late;
  Lateness woke_late;
  Lateness simulation_late;
};

class RunClock {
 public:
  /// `wall` must outlive the clock.
  RunClock(const ClockSettings& settings, WallClock& wall);

  /// Ties the simulated `time` to the present wall-clock time, or to the start that the clock sets. To be called before
  /// the first step.
  void start(fsw::GpsTime time);

  /// Waits until an event at `time` is due; in lock-step returns at once. Lateness beyond the tolerance is recorded in
  /// `late`, if that is not null, whatever the cause. False if `stop_requested` (called about ten times a second, may
  /// be empty) returned true before.
  bool wait_until(fsw::GpsTime time, Lateness* late, const std::function<bool()>& stop_requested = {});

  /// Waits for the step at `time` in the same way; the lateness is recorded for the report.
  bool begin_step(fsw::GpsTime time, const std::function<bool()>& stop_requested = {});

  /// Records the exchange of the step: wall time from the first packet out to the last packet in, and how much of it
  /// the flight computer spent computing.
  void end_exchange(WallClock::Span round_trip, WallClock::Span compute);

  [[nodiscard]] const DeadlineReport& report() const { return report_; }

 private:
  [[nodiscard]] WallClock::Span on_the_wall(fsw::Duration simulated) const;
  /// Lateness of the start of an event.
  struct Arrival {
    bool slept = false;
    WallClock::Span late{0};
  };
  std::optional<Arrival> await(fsw::GpsTime time, const std::function<bool()>& stop_requested);
  bool sleep_until(WallClock::Span due, const std::function<bool()>& stop_requested);

  ClockSettings settings_;
  WallClock& wall_;
  fsw::GpsTime start_;
  WallClock::Span wall_start_{0};
  WallClock::Span arrears_{0};  ///< lateness of the run when it was last recorded
  bool exchange_late_ = false;  ///< the last exchange exceeded a budget: the delay that it causes is recorded already
  DeadlineReport report_;
};

}  // namespace vbar::engine
