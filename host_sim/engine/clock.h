#pragma once
// Wall-clock time, as the clock of a run sees it. Tests substitute their own; a testbed may substitute a
// clock that follows its PPS edges.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "fsw/core/gps_time.h"

namespace vbar::engine {

class WallClock {
 public:
  using Span = std::chrono::nanoseconds;

  WallClock() = default;
  WallClock(const WallClock&) = delete;
  WallClock& operator=(const WallClock&) = delete;
  virtual ~WallClock() = default;

  /// Since an origin of the clock's own; monotonic.
  virtual Span now() = 0;
  /// Returns the start of the run, if it has been set (by a testbed); by default at once.
  virtual Span start_of_run() { return now(); }
  /// Returns at `wake` or later; at once if it has passed.
  virtual void sleep_until(Span wake) = 0;
};

/// The computer's monotonic clock.
class SteadyWallClock final : public WallClock {
 public:
  Span now() override;
  void sleep_until(Span wake) override;
};

/// A source of time, by the name that missions use.
struct WallClockSource {
  std::string_view name;
  /// `device`: the text after "<name>:" in the mission, possibly empty.
  std::unique_ptr<WallClock> (*make)(std::string_view device);
};

extern const WallClockSource kMonotonicClock;  ///< "monotonic", SteadyWallClock

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

// Times of a periodic event whose period changes at given times: flight steps, images.

/// A part begins at its own time; its epochs are one period after that, two periods, and so on, up to and including the
/// beginning of the next part.
class Cadence {
 public:
  struct Part {
    fsw::GpsTime from;
    fsw::Duration period;  ///< > 0
    friend bool operator==(const Part&, const Part&) = default;
  };

  /// Throws std::invalid_argument without a part, and for parts that are not in order of time.
  explicit Cadence(std::vector<Part> parts);
  Cadence(fsw::GpsTime from, fsw::Duration period) : Cadence(std::vector<Part>{{from, period}}) {}

  /// The first epoch later than `time`.
  [[nodiscard]] fsw::GpsTime next_after(fsw::GpsTime time) const;
  /// The first epoch at `time` or later.
  [[nodiscard]] fsw::GpsTime next_at(fsw::GpsTime time) const { return next_after(time - fsw::Duration{1}); }
  /// The number of epochs before `time`: the first epoch has number 0.
  [[nodiscard]] std::int64_t number_of(fsw::GpsTime time) const;

  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }
  [[nodiscard]] fsw::Duration shortest_period() const;

  friend bool operator==(const Cadence&, const Cadence&) = default;

 private:
  std::vector<Part> parts_;
};

}  // namespace vbar::engine
