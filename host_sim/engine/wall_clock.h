#pragma once
// Wall-clock time, as the clock of a run sees it. Tests substitute their own; a testbed may substitute a
// clock that follows its PPS edges.

#include <chrono>
#include <memory>
#include <string_view>

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

}  // namespace vbar::engine
