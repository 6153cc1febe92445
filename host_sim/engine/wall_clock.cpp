#include "host_sim/engine/wall_clock.h"

#include <thread>

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

}  // namespace vbar::engine
