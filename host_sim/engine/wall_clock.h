#pragma once
// The time of the world outside, as the run's clock sees it. Tests put their own in its place; a testbed may put a
// clock there that follows its PPS edges.

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

  /// Since an origin of the clock's own; never goes back.
  virtual Span now() = 0;
  /// Returns at `wake` or later, at once if it is past.
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
  /// `device`: what follows "<name>:" in the mission, empty if nothing does.
  std::unique_ptr<WallClock> (*make)(std::string_view device);
};

extern const WallClockSource kMonotonicClock;  ///< "monotonic", SteadyWallClock

}  // namespace vbar::engine
