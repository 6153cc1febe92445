#pragma once
// Pictures that are on a display during an exposure.
//
// Pace "fast": what is on the screen now; it has been there for longer than the display's latency. Pace "real": the
// screen is taken at every refresh, shown by the display a number of refreshes later and for one period, and each
// pixel follows exponentially.

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "hil_drivers/optical_stimulator/bench/bench_settings.h"
#include "hil_drivers/optical_stimulator/bench/screen/panel.h"

namespace vbar::optical_stimulator::bench {

using ReadScreen = std::function<void(std::vector<std::uint8_t>& grey)>;

/// Holds a picture that the display begins to show at `begin_s`.
struct TimedPicture {
  double begin_s = 0.0;
  std::shared_ptr<const std::vector<std::uint8_t>> counts;
};

/// Returns the parts of the light of an exposure from `begin_s` to `end_s`: pictures in order, the first of which was
/// shown before it; `response_s`: time constant of the pixels.
[[nodiscard]] Pictures pictures_of(const std::deque<TimedPicture>& shown, double begin_s, double end_s,
                                   double response_s);

class ScreenWatch {
 public:
  using Clock = std::chrono::steady_clock;

  /// Starts a thread in pace "real", which calls `read`.
  ScreenWatch(const DisplaySettings& settings, Pace pace, ReadScreen read);
  ~ScreenWatch();
  ScreenWatch(const ScreenWatch&) = delete;
  ScreenWatch& operator=(const ScreenWatch&) = delete;

  /// Returns the pictures of an exposure that began at `begin`; in pace "real" it has ended when this returns.
  [[nodiscard]] Pictures during(Clock::time_point begin, double exposure_s);

 private:
  void watch(const std::stop_token& stop);

  DisplaySettings settings_;
  ReadScreen read_;
  Clock::time_point origin_ = Clock::now();
  std::mutex mutex_;
  std::deque<TimedPicture> shown_;
  std::jthread thread_;  // last: it uses all the others
};

}  // namespace vbar::optical_stimulator::bench
